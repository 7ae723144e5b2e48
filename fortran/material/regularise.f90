!> Compressive softening that uses up the same energy per area of a band, whatever its width.
!>
!> Beyond Klerck, Sellers & Owen 2004, whose compressive part is purely local: a band of one
!> element localises, so its dissipation falls with the element. As eq. 16 does for tension, the
!> part of the tables beyond the peak strength is stretched: with k the strain of Table 1 and
!> k0 that of the peak, a band of width h_c has
!>    e = k                             up to k0,
!>    e = k0 + (k - k0) reference/h_c   beyond,
!> so that h_c times the work beyond k0 does not depend on h_c. Cohesion, friction and dilation
!> are stretched alike. The width is that of the tension planes: H is proportional to it.
!> A rock without a reference width never comes here.
module lithofrac_material_regularise
   use lithofrac_base_kinds, only: wp
   use lithofrac_material_rock, only: rock_type
   use lithofrac_material_table, only: table_segment, table_type
   use lithofrac_material_tension_planes, only: softening_modulus
   implicit none
   private

   public :: regularises, rock_of_band, segment_of_band, table_strain

contains

   !> True if the tables of the rock depend on the width of the band.
   pure function regularises(rock)
      type(rock_type), intent(in) :: rock
      logical :: regularises

      regularises = rock%onset > 0
   end function regularises

   !> The rock with the tables that hold in a band.
   pure subroutine rock_of_band(rock, softening, own)
      type(rock_type), intent(in) :: rock     !! with a reference width
      real(wp), intent(in) :: softening       !! H of the band, negative [Pa]
      type(rock_type), intent(out) :: own

      real(wp) :: stretch

      own = rock
      stretch = softening_modulus(rock, rock%reference_width)/softening
      call stretch_table(own%cohesion, rock%onset, stretch)
      call stretch_table(own%friction, rock%onset, stretch)
      call stretch_table(own%dilation, rock%onset, stretch)
   end subroutine rock_of_band

   !> Strain at which the tables as they stand have what a band has at `ep_eff`.
   pure function table_strain(rock, softening, ep_eff) result(k)
      type(rock_type), intent(in) :: rock
      real(wp), intent(in) :: softening       !! H of the band, negative [Pa]
      real(wp), intent(in) :: ep_eff          !! effective plastic strain [-]
      real(wp) :: k

      real(wp) :: onset, shrink

      k = ep_eff
      if (.not. regularises(rock)) return
      onset = rock%cohesion%x(rock%onset)
      if (ep_eff <= onset) return
      shrink = softening/softening_modulus(rock, rock%reference_width)
      k = shrink*ep_eff + (1.0_wp - shrink)*onset
   end function table_strain

   !> Segment of the tables that holds a strain in a band, where it starts and ends there, and how
   !> much longer it is than in the tables as they stand.
   pure subroutine segment_of_band(rock, softening, ep_eff, segment, origin, knot, stretch)
      type(rock_type), intent(in) :: rock
      real(wp), intent(in) :: softening       !! H of the band, negative [Pa]
      real(wp), intent(in) :: ep_eff          !! effective plastic strain [-]
      integer, intent(out) :: segment
      real(wp), intent(out) :: origin         !! [-]
      real(wp), intent(out) :: knot           !! huge beyond the last row [-]
      real(wp), intent(out) :: stretch        !! [-]

      real(wp) :: start

      segment = table_segment(rock%cohesion, table_strain(rock, softening, ep_eff))
      origin = rock%cohesion%origin(segment)
      knot = huge(knot)
      if (segment < rock%cohesion%n) knot = rock%cohesion%x(segment + 1)
      stretch = 1.0_wp
      if (.not. regularises(rock) .or. segment < rock%onset) return
      start = rock%cohesion%x(rock%onset)
      stretch = softening_modulus(rock, rock%reference_width)/softening
      origin = stretch*origin + (1.0_wp - stretch)*start
      if (segment < rock%cohesion%n) knot = stretch*knot + (1.0_wp - stretch)*start
   end subroutine segment_of_band

   !> Move the rows beyond row `onset` away from it. A stretch of 1 changes no bit.
   pure subroutine stretch_table(table, onset, stretch)
      type(table_type), intent(inout) :: table
      integer, intent(in) :: onset
      real(wp), intent(in) :: stretch

      associate (n => table%n, start => table%x(onset))
         table%x(onset + 1:n) = stretch*table%x(onset + 1:n) + (1.0_wp - stretch)*start
         table%origin(onset + 1:n) = table%x(onset + 1:n)
         table%slope(onset:n) = table%slope(onset:n)/stretch
      end associate
   end subroutine stretch_table

end module lithofrac_material_regularise
