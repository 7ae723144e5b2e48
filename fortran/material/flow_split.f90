!> The least compressive flow that explains a known inelastic strain.
!>
!> Where more planes meet than the strain needs (two exhausted tension planes on an edge of
!> the pyramid, the apex at the origin), eq. 9 leaves the split of the strain between
!> Mohr-Coulomb and tension multipliers open. Choice: the split with the smallest effective
!> plastic strain, as much tension flow as possible; `x` below is the Mohr-Coulomb part.
!> It minimises |x| over the cone of the active Mohr-Coulomb planes, with d - x >= 0 on active
!> tension planes and d = x on the others: a water-filling problem with a closed form.
module lithofrac_material_flow_split
   use lithofrac_base_kinds, only: wp
   use lithofrac_material_mohr_coulomb, only: mobilised_type
   implicit none
   private

   public :: least_flow_at_apex, least_flow_of_equal_maxima, least_flow_of_equal_minima

contains

   !> All six planes active. The cone is: sum of positive parts >= a/b times sum of negative
   !> parts. A strain that needs more positive flow than is there is left whole.
   pure subroutine least_flow_at_apex(now, d, open, x)
      type(mobilised_type), intent(in) :: now
      real(wp), intent(in) :: d(3)     !! inelastic strain increments [-]
      logical, intent(in) :: open(3)   !! tension plane i is active
      real(wp), intent(out) :: x(3)

      real(wp) :: fixed, need

      x = d
      where (open .and. d > 0.0_wp) x = 0.0_wp
      need = -now%a_flow/now%b_flow*sum(min(x, 0.0_wp))
      fixed = sum(max(x, 0.0_wp))
      if (need > fixed) call fill(need - fixed, d, open .and. d > 0.0_wp, x)
   end subroutine least_flow_at_apex

   !> Planes (i, k) and (j, k) active: s_i = s_j is the largest stress.
   pure subroutine least_flow_of_equal_maxima(now, d, open, i, j, k, x)
      type(mobilised_type), intent(in) :: now
      real(wp), intent(in) :: d(3)
      logical, intent(in) :: open(3)
      integer, intent(in) :: i, j, k   !! axes: two largest, smallest
      real(wp), intent(out) :: x(3)

      real(wp) :: fixed, need

      x = 0.0_wp
      if (.not. open(i)) x(i) = d(i)
      if (.not. open(j)) x(j) = d(j)
      fixed = x(i) + x(j)
      need = now%a_flow/now%b_flow*max(0.0_wp, -d(k))
      if (need > fixed) call fill(need - fixed, d, open .and. [1, 2, 3] /= k, x)
      x(k) = -now%b_flow/now%a_flow*(x(i) + x(j))
   end subroutine least_flow_of_equal_maxima

   !> Planes (i, j) and (i, k) active: s_j = s_k is the smallest stress.
   pure subroutine least_flow_of_equal_minima(now, d, open, i, j, k, x)
      type(mobilised_type), intent(in) :: now
      real(wp), intent(in) :: d(3)
      logical, intent(in) :: open(3)
      integer, intent(in) :: i, j, k   !! axes: largest, two smallest
      real(wp), intent(out) :: x(3)

      real(wp) :: need

      x = min(d, 0.0_wp)
      if (.not. open(i)) then
         need = now%b_flow/now%a_flow*d(i)
         if (need + x(j) + x(k) > 0.0_wp .and. open(j) .and. open(k)) call level(need, x(j), x(k))
      end if
      x(i) = -now%a_flow/now%b_flow*(x(j) + x(k))
   end subroutine least_flow_of_equal_minima

   !> Share `amount` between the axes of `open` as evenly as their `caps` allow.
   pure subroutine fill(amount, caps, open, x)
      real(wp), intent(in) :: amount
      real(wp), intent(in) :: caps(3)
      logical, intent(in) :: open(3)
      real(wp), intent(inout) :: x(3)

      integer :: i, trip
      logical :: filling(3)
      real(wp) :: rest, share

      filling = open
      rest = amount
      do trip = 1, 3
         if (count(filling) == 0) return
         share = rest/real(count(filling), wp)
         if (all(caps >= share .or. .not. filling)) exit
         do i = 1, 3
            if (filling(i) .and. caps(i) < share) then
               x(i) = caps(i)
               rest = rest - caps(i)
               filling(i) = .false.
            end if
         end do
      end do
      where (filling) x = share
   end subroutine fill

   !> Lower two non-positive numbers to the sum -`need`, as evenly as possible.
   pure subroutine level(need, first, second)
      real(wp), intent(in) :: need
      real(wp), intent(inout) :: first, second

      real(wp) :: half

      half = -0.5_wp*need
      if (first < half) then
         second = -need - first
      else if (second < half) then
         first = -need - second
      else
         first = half
         second = half
      end if
   end subroutine level

end module lithofrac_material_flow_split
