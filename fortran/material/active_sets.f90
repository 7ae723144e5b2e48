!> The feasible returns, as a list: which planes may be active together.
!>
!> Stresses are sorted here, 1 the largest trial stress and 3 the smallest. An active set is
!> a group of tension planes and one of 14 groups of Mohr-Coulomb planes: none, one of the six
!> ordered pairs (i, j), one of the six edges of the pyramid, or its apex.
!> Sets whose flow directions depend on each other are left out: another set, or a point where
!> two sets meet, gives the same answer (Klerck, Sellers & Owen 2004, section 2.4 and Fig. 2b).
module lithofrac_material_active_sets
   implicit none
   private

   public :: n_groups, n_members, member_high, member_low, no_planes, main_plane, apex
   public :: feasible, edge_of, plane_bit, tension_count

   integer, parameter :: n_groups = 14
   integer, parameter :: no_planes = 1  !! group without Mohr-Coulomb planes
   integer, parameter :: main_plane = 2 !! group of the plane of the extreme trial stresses
   integer, parameter :: apex = 14      !! group of all six planes

   !> Planes in each group; the apex is treated on its own.
   integer, parameter :: n_members(n_groups) = [0, 1, 2, 2, 1, 1, 2, 2, 1, 1, 1, 2, 2, 0]

   !> Larger stress i of the planes of each group, in order of likelihood.
   integer, parameter :: member_high(2, n_groups) = reshape( &
      [0, 0, 1, 0, 1, 2, 1, 1, 2, 0, 1, 0, 2, 2, 1, 3, 3, 0, 2, 0, 3, 0, 2, 3, 3, 3, 0, 0], &
      [2, n_groups])

   !> Smaller stress j of the planes of each group.
   integer, parameter :: member_low(2, n_groups) = reshape( &
      [0, 0, 3, 0, 3, 3, 3, 2, 3, 0, 2, 0, 3, 1, 2, 2, 2, 0, 1, 0, 1, 0, 1, 1, 1, 2, 0, 0], &
      [2, n_groups])

   !> Number of tension planes in a group of them (bits 0 to 2).
   integer, parameter :: tension_count(0:7) = [0, 1, 1, 2, 1, 2, 2, 3]

   !> Bit of the Mohr-Coulomb plane (i, j) in an active mask.
   integer, parameter :: plane_bit(3, 3) = reshape([0, 5, 7, 3, 0, 8, 4, 6, 0], [3, 3])

contains

   !> True if the flow directions of these planes are independent (no plane: no flow).
   pure function feasible(tension, group)
      integer, intent(in) :: tension  !! tension planes, bits 0 to 2
      integer, intent(in) :: group
      logical :: feasible

      select case (n_members(group))
      case (0)
         feasible = group == no_planes .or. tension == 0
      case (1)
         feasible = .not. (btest(tension, member_high(1, group) - 1) .and. &
            btest(tension, member_low(1, group) - 1))
      case default
         feasible = tension_count(tension) <= 1
      end select
   end function feasible

   !> Group of the two planes (i, k) and (j, k), or (k, i) and (k, j) if `k` is the larger stress.
   pure function edge_of(i, j, k, larger) result(group)
      integer, intent(in) :: i, j, k
      logical, intent(in) :: larger  !! `k` is the larger stress of both planes
      integer :: group

      integer :: one, two

      do group = 1, n_groups
         if (n_members(group) /= 2) cycle
         if (larger) then
            if (any(member_high(:, group) /= k)) cycle
            one = member_low(1, group)
            two = member_low(2, group)
         else
            if (any(member_low(:, group) /= k)) cycle
            one = member_high(1, group)
            two = member_high(2, group)
         end if
         if (min(one, two) == min(i, j) .and. max(one, two) == max(i, j)) return
      end do
      group = no_planes
   end function edge_of

end module lithofrac_material_active_sets
