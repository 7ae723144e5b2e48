!> Block Gauss-Seidel over pairs: every pair is solved exactly in turn, until none changes.
!>
!> Starts from the impulses of the step before. The first sweep solves every pair, each later one
!> only those whose nodes another pair has moved since, in the opposite direction to the sweep
!> before. The order of the pairs alone decides the bits of the result.
module lithofrac_contact_multipliers
   use lithofrac_base_kinds, only: wp
   use lithofrac_contact_friction, only: one_face, two_faces
   use lithofrac_contact_pairs, only: pair_type
   implicit none
   private

   public :: queue_type, solve_pairs

   !> Room to remember which pairs have to be solved again.
   type :: queue_type
      integer, allocatable :: newest(:)   !! (n) 4*pair + place, last pair of a boundary node
      integer, allocatable :: next(:)     !! pairs of the sweep to come
      integer, allocatable :: now(:)      !! pairs of this sweep
   end type queue_type

contains

   !> Find the impulses; velocities come out with them.
   pure subroutine solve_pairs(pairs, inverse_mass, tolerance, most_sweeps, v, queue, sweeps, &
         converged)
      type(pair_type), intent(inout), contiguous :: pairs(:)  !! `impulse` a guess, the solution
      real(wp), intent(in), contiguous :: inverse_mass(:, :)  !! (2, n) [1/kg]
      real(wp), intent(in) :: tolerance             !! change of a relative velocity [m/s]
      integer, intent(in) :: most_sweeps
      real(wp), intent(inout), contiguous :: v(:, :)  !! (2, n) without contact, then with [m/s]
      type(queue_type), intent(inout) :: queue
      integer, intent(out) :: sweeps
      logical, intent(out) :: converged

      integer :: i, k, first, last
      logical :: moved

      call link_pairs(pairs, queue%newest)
      do i = 1, size(pairs)
         call add_impulse(pairs(i), pairs(i)%impulse(1), pairs(i)%impulse(2), inverse_mass, v)
      end do
      last = 0
      do i = 1, size(pairs)
         call visit_pair(pairs(i), inverse_mass, tolerance, v, moved)
         if (moved) call wake(pairs, i, i - 1, queue, last)
      end do
      do sweeps = 1, most_sweeps
         converged = last == 0
         if (converged) return
         first = last
         queue%now(:last) = queue%next(:last)
         last = 0
         do k = first, 1, -1
            i = queue%now(k)
            pairs(i)%is_queued = .false.
            call visit_pair(pairs(i), inverse_mass, tolerance, v, moved)
            if (moved) call wake(pairs, i, size(pairs), queue, last)
         end do
      end do
   end subroutine solve_pairs

   !> Chain the pairs of every node, newest first.
   pure subroutine link_pairs(pairs, newest)
      type(pair_type), intent(inout), contiguous :: pairs(:)
      integer, intent(inout), contiguous :: newest(:)   !! (n) 4*pair + place of the node in it

      integer :: i, k

      do i = 1, size(pairs)
         do k = 1, 4
            newest(pairs(i)%node(k)) = 0
         end do
      end do
      do i = 1, size(pairs)
         pairs(i)%is_queued = .false.
         do k = 1, pairs(i)%n_nodes
            pairs(i)%older(k) = newest(pairs(i)%node(k))
            newest(pairs(i)%node(k)) = 4*i + k - 1
         end do
      end do
   end subroutine link_pairs

   !> Queue the pairs that share a node with pair `i`, up to number `last_pair`.
   pure subroutine wake(pairs, i, last_pair, queue, n)
      type(pair_type), intent(inout), contiguous :: pairs(:)
      integer, intent(in) :: i
      integer, intent(in) :: last_pair      !! those behind it are still to be visited
      type(queue_type), intent(inout) :: queue
      integer, intent(inout) :: n           !! pairs in the queue

      integer :: k, entry, other

      do k = 1, pairs(i)%n_nodes
         entry = queue%newest(pairs(i)%node(k))
         do while (entry > 0)
            other = entry/4
            entry = pairs(other)%older(modulo(entry, 4) + 1)
            if (other > last_pair .or. other == i .or. pairs(other)%is_queued) cycle
            pairs(other)%is_queued = .true.
            n = n + 1
            queue%next(n) = other
         end do
      end do
   end subroutine wake

   !> Solve one pair; tell if that has moved its nodes.
   pure subroutine visit_pair(pair, inverse_mass, tolerance, v, moved)
      type(pair_type), intent(inout) :: pair
      real(wp), intent(in), contiguous :: inverse_mass(:, :)
      real(wp), intent(in) :: tolerance
      real(wp), intent(inout), contiguous :: v(:, :)
      logical, intent(out) :: moved

      real(wp) :: p(2), change(2)

      call solve_pair(pair, v, p)
      change(1) = p(1) - pair%impulse(1)
      change(2) = p(2) - pair%impulse(2)
      moved = .false.
      if (.not. max(abs(change(1)), abs(change(2))) > 0.0_wp) return
      pair%impulse(1) = p(1)
      pair%impulse(2) = p(2)
      call add_impulse(pair, change(1), change(2), inverse_mass, v)
      moved = max(abs(change(1))*pair%compliance(1), abs(change(2))*pair%compliance(2)) &
         > tolerance
   end subroutine visit_pair

   !> Impulse of one pair when all others keep theirs.
   !>
   !> The common cases stand here: a pair that is open, that sticks, or at two faces that press
   !> both. All others are left to the closed forms of `friction`.
   pure subroutine solve_pair(pair, v, p)
      type(pair_type), intent(in) :: pair
      real(wp), intent(in), contiguous :: v(:, :)
      real(wp), intent(out) :: p(2)                 !! [N s]

      real(wp) :: d0(2), normal, along

      associate (node => pair%node, weight => pair%weight, n => pair%normal, w => pair%compliance)
         d0(1) = weight(1)*v(1, node(1)) + weight(2)*v(1, node(2)) + weight(3)*v(1, node(3))
         d0(2) = weight(1)*v(2, node(1)) + weight(2)*v(2, node(2)) + weight(3)*v(2, node(3))
         if (pair%n_nodes == 4) then
            d0(1) = d0(1) + weight(4)*v(1, node(4))
            d0(2) = d0(2) + weight(4)*v(2, node(4))
         end if
         d0(1) = d0(1) - w(1)*pair%impulse(1)
         d0(2) = d0(2) - w(2)*pair%impulse(2)
         ! what takes the pair to rest at its faces
         p(1) = (pair%rest(1) - d0(1))*pair%stiffness(1)
         p(2) = (pair%rest(2) - d0(2))*pair%stiffness(2)
         if (pair%n_faces == 1) then
            normal = p(1)*n(1, 1) + p(2)*n(2, 1)
            along = p(2)*n(1, 1) - p(1)*n(2, 1)
            if (d0(1)*n(1, 1) + d0(2)*n(2, 1) + pair%bias(1) >= 0.0_wp) then
               p = 0.0_wp
            else if (.not. (abs(along) <= pair%friction*normal .and. pair%friction > 0.0_wp)) then
               p = one_face(d0, n(:, 1), pair%bias(1), pair%friction, w)
            end if
         else if (.not. (pair%turn*(p(1)*n(2, 2) - p(2)*n(1, 2)) > 0.0_wp .and. &
            pair%turn*(n(1, 1)*p(2) - n(2, 1)*p(1)) > 0.0_wp)) then
            p = two_faces(d0, n, pair%bias, pair%friction, w)
         end if
      end associate
   end subroutine solve_pair

   !> Change the velocities by an impulse of the pair.
   pure subroutine add_impulse(pair, x, y, inverse_mass, v)
      type(pair_type), intent(in) :: pair
      real(wp), intent(in) :: x, y                  !! [N s]
      real(wp), intent(in), contiguous :: inverse_mass(:, :)
      real(wp), intent(inout), contiguous :: v(:, :)

      integer :: k

      do k = 1, 3
         associate (node => pair%node(k))
            v(1, node) = v(1, node) + inverse_mass(1, node)*(pair%weight(k)*x)
            v(2, node) = v(2, node) + inverse_mass(2, node)*(pair%weight(k)*y)
         end associate
      end do
      if (pair%n_nodes < 4) return
      associate (node => pair%node(4))
         v(1, node) = v(1, node) + inverse_mass(1, node)*(pair%weight(4)*x)
         v(2, node) = v(2, node) + inverse_mass(2, node)*(pair%weight(4)*y)
      end associate
   end subroutine add_impulse

end module lithofrac_contact_multipliers
