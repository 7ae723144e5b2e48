!> Two boundary nodes at one place: which faces keep their wedges of material apart.
!>
!> A line through the point separates the wedges if it stands between two limits, each along one
!> of the four edges. Both wedges convex: any such line will do.
!> One re-entrant: the limits swap and both faces hold at once.
module lithofrac_contact_corners
   use lithofrac_base_kinds, only: pi, wp
   implicit none
   private

   public :: classify, no_corner, any_face, both_faces, flat_face
   public :: before_first, after_first, before_second, after_second

   integer, parameter :: no_corner = 0   !! the wedges do not meet at their tips
   integer, parameter :: any_face = 1    !! any normal from face 1 to face 2 (convex, convex)
   integer, parameter :: both_faces = 2  !! re-entrant
   integer, parameter :: flat_face = 3   !! the two faces agree but for a small angle

   ! The four edges at the two nodes.
   integer, parameter :: before_first = 1, after_first = 2, before_second = 3, after_second = 4

   real(wp), parameter :: wrap = 0.05_wp        !! a gap above 2 pi - wrap is an overlap [rad]
   real(wp), parameter :: overlap = 1.0_wp      !! wedges that overlap more meet elsewhere [rad]
   real(wp), parameter :: neighbour = 0.5_wp    !! nothing fits between wedges closer than it [rad]
   real(wp), parameter :: flat = 0.03_wp        !! below it two faces are one [rad]

contains

   !> Kind of a corner and its limiting faces, from the unit tangents of the four edges.
   pure subroutine classify(into_first, out_of_first, into_second, out_of_second, kind, face, &
         neighbours)
      real(wp), intent(in) :: into_first(2)     !! edge that ends at the first node
      real(wp), intent(in) :: out_of_first(2)   !! edge that starts there
      real(wp), intent(in) :: into_second(2)
      real(wp), intent(in) :: out_of_second(2)
      integer, intent(out) :: kind
      integer, intent(out) :: face(2)           !! edges of the lower and the upper limit
      logical, intent(out) :: neighbours        !! no third wedge stands between the two

      real(wp) :: first, second, gap(2), lower, upper

      kind = no_corner
      face = 0
      neighbours = .false.
      first = angle(out_of_first, -into_first)
      second = angle(out_of_second, -into_second)
      gap = [angle(-into_first, out_of_second), angle(-into_second, out_of_first)]
      where (gap > 2.0_wp*pi - wrap) gap = gap - 2.0_wp*pi
      if (sum(gap) + first + second > 2.0_wp*pi + overlap) return
      neighbours = minval(gap) <= neighbour
      lower = max(0.0_wp, gap(1) + second - pi)
      upper = min(gap(1), pi - first)
      face(1) = merge(before_second, before_first, gap(1) + second - pi > 0.0_wp)
      face(2) = merge(after_second, after_first, gap(1) < pi - first)
      if (abs(lower - upper) < flat) then
         kind = flat_face
      else if (lower > upper) then
         kind = both_faces
         neighbours = .true.
      else
         kind = any_face
      end if
   end subroutine classify

   !> Angle from a to b, counter-clockwise, in [0, 2 pi).
   pure function angle(a, b)
      real(wp), intent(in) :: a(2)
      real(wp), intent(in) :: b(2)
      real(wp) :: angle

      angle = atan2(a(1)*b(2) - a(2)*b(1), a(1)*b(1) + a(2)*b(2))
      if (angle < 0.0_wp) angle = angle + 2.0_wp*pi
   end function angle

end module lithofrac_contact_corners
