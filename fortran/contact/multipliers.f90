!> Block Gauss-Seidel over pairs: every pair is solved exactly in turn, until none changes.
!>
!> Starts from the impulses of the step before. The first sweep solves every pair, each later one
!> only those whose nodes another pair has moved since, in the opposite direction to the sweep
!> before. Islands that share no node can be solved at the same time: the order of the
!> pairs within each alone decides the bits of the result.
module lithofrac_contact_multipliers
   use lithofrac_base_kinds, only: wp
   use lithofrac_contact_friction, only: one_face, two_faces
   use lithofrac_contact_pairs, only: motion_type, pair_type
   implicit none
   private

   public :: queue_type, solve_pairs

   integer, parameter :: early_sweeps = 8  !! slip that goes to and fro needs no more of them
   integer, parameter :: calm_after = 20   !! sweeps; who still goes round in circles is slowed
   real(wp), parameter :: calm = 0.5_wp    !! part of a change that is then taken
   real(wp), parameter :: late = 8.0_wp    !! tolerance after the early sweeps, over that before
   real(wp), parameter :: share = 0.25_wp  !! of it that one pair may do to another unseen

   !> Room to remember which pairs have to be solved again.
   type :: queue_type
      integer, allocatable :: newest(:)   !! (n) 4*pair + place, last pair of a boundary node
      integer, allocatable :: older(:, :) !! (4, pairs) the same for the pair before, by place
      integer, allocatable :: next(:)     !! pairs of the sweep to come, in the part of the group
      integer, allocatable :: now(:)      !! pairs of this sweep
   end type queue_type

contains

   !> Find the impulses of a group of islands; velocities come out with them.
   pure subroutine solve_pairs(pairs, order, first, last, motion, tolerance, most_sweeps, queue, &
      sweeps, converged)
      type(pair_type), intent(inout), contiguous :: pairs(:)  !! `impulse` a guess, the solution
      integer, intent(in), contiguous :: order(:)
      integer, intent(in) :: first, last            !! of the group, into `order`
      type(motion_type), intent(inout), contiguous :: motion(:)  !! (n)
      real(wp), intent(in) :: tolerance             !! change of a relative velocity [m/s]
      integer, intent(in) :: most_sweeps
      type(queue_type), intent(inout) :: queue      !! `newest` 0 where pairs are
      integer, intent(out) :: sweeps
      logical, intent(out) :: converged

      integer :: i, k, n, queued
      real(wp) :: enough

      do k = first, last
         i = order(k)
         call link_pair(pairs(i), i, queue)
         call add_impulse(pairs(i), pairs(i)%impulse(1), pairs(i)%impulse(2), motion)
      end do
      queued = 0
      do k = first, last
         i = order(k)
         pairs(i)%is_queued = .false.
         call visit_pair(pairs, i, motion, tolerance, 1.0_wp, queue, first, queued)
      end do
      do sweeps = 1, most_sweeps - 1
         converged = queued == 0
         if (converged) return
         n = queued
         enough = merge(tolerance, late*tolerance, sweeps <= early_sweeps)
         queue%now(first:first + n - 1) = queue%next(first:first + n - 1)
         queued = 0
         do k = first + n - 1, first, -1
            i = queue%now(k)
            pairs(i)%is_queued = .false.
            call visit_pair(pairs, i, motion, enough, merge(1.0_wp, calm, sweeps <= calm_after), &
               queue, first, queued)
         end do
      end do
      converged = queued == 0
   end subroutine solve_pairs

   !> Chain the pairs of every node, newest first; all wait for the first sweep.
   pure subroutine link_pair(pair, number, queue)
      type(pair_type), intent(inout) :: pair
      integer, intent(in) :: number
      type(queue_type), intent(inout) :: queue

      integer :: k

      pair%is_queued = .true.
      do k = 1, pair%n_nodes
         queue%older(k, number) = queue%newest(pair%node(k))
         queue%newest(pair%node(k)) = 4*number + k - 1
      end do
   end subroutine link_pair

   !> Solve pair `i`; queue the pairs that feel it.
   pure subroutine visit_pair(pairs, i, motion, tolerance, part, queue, first, n)
      type(pair_type), intent(inout), contiguous :: pairs(:)
      integer, intent(in) :: i
      type(motion_type), intent(inout), contiguous :: motion(:)
      real(wp), intent(in) :: tolerance     !! change of a relative velocity [m/s]
      real(wp), intent(in) :: part          !! of the change of its impulse that is taken
      type(queue_type), intent(inout) :: queue
      integer, intent(in) :: first          !! place of the group in the queue
      integer, intent(inout) :: n           !! its pairs in the queue

      real(wp) :: p(2), x, y, dv, largest
      integer :: k

      call solve_pair(pairs(i), motion, p)
      associate (pair => pairs(i))
         x = part*(p(1) - pair%impulse(1))
         y = part*(p(2) - pair%impulse(2))
         if (.not. max(abs(x), abs(y)) > 0.0_wp) return
         if (part < 1.0_wp) then
            p(1) = pair%impulse(1) + x
            p(2) = pair%impulse(2) + y
         end if
         pair%impulse(1) = p(1)
         pair%impulse(2) = p(2)
         call add_impulse(pair, x, y, motion)
         largest = 0.0_wp
         do k = 1, pair%n_nodes
            associate (at => motion(pair%node(k)))
               dv = abs(pair%weight(k))*max(abs(x)*at%inverse_mass(1), abs(y)*at%inverse_mass(2))
            end associate
            largest = max(largest, dv)
            if (dv > share*tolerance) call wake(pairs, i, queue%newest(pair%node(k)), &
               share*tolerance/dv, queue, first, n)
         end do
         ! What was not taken is still to come.
         if ((1.0_wp - part)*largest <= part*share*tolerance .or. pair%is_queued) return
         pair%is_queued = .true.
         queue%next(first + n) = i
         n = n + 1
      end associate
   end subroutine visit_pair

   !> Queue the other pairs of a node that has moved, unless they have little weight there.
   pure subroutine wake(pairs, i, newest, least, queue, first, n)
      type(pair_type), intent(inout), contiguous :: pairs(:)
      integer, intent(in) :: i
      integer, intent(in) :: newest         !! 4*pair + place, of the node
      real(wp), intent(in) :: least         !! weight that counts
      type(queue_type), intent(inout) :: queue
      integer, intent(in) :: first
      integer, intent(inout) :: n

      integer :: entry, other, place

      entry = newest
      do while (entry > 0)
         other = entry/4
         place = modulo(entry, 4) + 1
         entry = queue%older(place, other)
         if (other == i .or. pairs(other)%is_queued) cycle
         if (abs(pairs(other)%weight(place)) <= least) cycle
         pairs(other)%is_queued = .true.
         queue%next(first + n) = other
         n = n + 1
      end do
   end subroutine wake

   !> Impulse of one pair when all others keep theirs.
   !>
   !> The common cases stand here: a pair that is open or sticks, two faces that press both. All
   !> others are left to the closed forms of `friction`.
   pure subroutine solve_pair(pair, motion, p)
      type(pair_type), intent(in) :: pair
      type(motion_type), intent(in), contiguous :: motion(:)
      real(wp), intent(out) :: p(2)                 !! [N s]

      real(wp) :: d(2), normal, along, turn
      integer :: k

      associate (n => pair%normal)
         d = 0.0_wp
         do k = 1, pair%n_nodes
            d(1) = d(1) + pair%weight(k)*motion(pair%node(k))%v(1)
            d(2) = d(2) + pair%weight(k)*motion(pair%node(k))%v(2)
         end do
         ! what takes the pair to rest at its faces
         p(1) = pair%impulse(1) + (pair%rest(1) - d(1))*pair%stiffness(1)
         p(2) = pair%impulse(2) + (pair%rest(2) - d(2))*pair%stiffness(2)
         if (pair%n_faces == 1) then
            normal = p(1)*n(1, 1) + p(2)*n(2, 1)
            along = p(2)*n(1, 1) - p(1)*n(2, 1)
            if (normal > 0.0_wp .and. abs(along) <= pair%friction*normal) return
         else
            turn = n(1, 1)*n(2, 2) - n(2, 1)*n(1, 2)
            if (turn*(p(1)*n(2, 2) - p(2)*n(1, 2)) > 0.0_wp .and. &
               turn*(n(1, 1)*p(2) - n(2, 1)*p(1)) > 0.0_wp) return
         end if
      end associate
      p = limited(pair, d)
   end subroutine solve_pair

   !> Impulse of a pair that may open or slide.
   pure function limited(pair, d) result(p)
      type(pair_type), intent(in) :: pair
      real(wp), intent(in) :: d(2)                  !! relative velocity with its impulse [m/s]
      real(wp) :: p(2)

      real(wp) :: d0(2), w(2), bias(2)

      w = 1.0_wp/pair%stiffness
      d0 = d - w*pair%impulse
      bias(1) = -(pair%rest(1)*pair%normal(1, 1) + pair%rest(2)*pair%normal(2, 1))
      if (pair%n_faces == 1) then
         p = one_face(d0, pair%normal(:, 1), bias(1), pair%friction, w)
      else
         bias(2) = -(pair%rest(1)*pair%normal(1, 2) + pair%rest(2)*pair%normal(2, 2))
         p = two_faces(d0, pair%normal, bias, pair%friction, w)
      end if
   end function limited

   !> Change the velocities by an impulse of the pair.
   pure subroutine add_impulse(pair, x, y, motion)
      type(pair_type), intent(in) :: pair
      real(wp), intent(in) :: x, y                  !! [N s]
      type(motion_type), intent(inout), contiguous :: motion(:)

      integer :: k

      do k = 1, pair%n_nodes
         associate (at => motion(pair%node(k)))
            at%v(1) = at%v(1) + at%inverse_mass(1)*(pair%weight(k)*x)
            at%v(2) = at%v(2) + at%inverse_mass(2)*(pair%weight(k)*y)
         end associate
      end do
   end subroutine add_impulse

end module lithofrac_contact_multipliers
