!> Block Gauss-Seidel over pairs: every pair is solved exactly in turn, until none changes.
!>
!> Sweeps go forward and backward in turn and start from the impulses of the step before. After
!> the first sweep only those pairs are solved again whose nodes another pair has moved since.
!> The order of the pairs alone decides the bits of the result.
module lithofrac_contact_multipliers
   use lithofrac_base_kinds, only: wp
   use lithofrac_contact_friction, only: one_face, two_faces
   use lithofrac_contact_pairs, only: pair_type
   implicit none
   private

   public :: solve_pairs

contains

   !> Find the impulses; velocities come out with them.
   pure subroutine solve_pairs(pairs, inverse_mass, tolerance, most_sweeps, v, woken, sweeps, &
         converged)
      type(pair_type), intent(inout), contiguous :: pairs(:)  !! `impulse` a guess, the solution
      real(wp), intent(in), contiguous :: inverse_mass(:, :)  !! (2, n) [1/kg]
      real(wp), intent(in) :: tolerance             !! change of a relative velocity [m/s]
      integer, intent(in) :: most_sweeps
      real(wp), intent(inout), contiguous :: v(:, :)  !! (2, n) without contact, then with [m/s]
      integer, intent(inout), contiguous :: woken(:)  !! (n) scratch: visit that moved a node
      integer, intent(out) :: sweeps
      logical, intent(out) :: converged

      integer :: i, k, visit

      do i = 1, size(pairs)
         woken(pairs(i)%node) = 0
         call add_impulse(pairs(i), pairs(i)%impulse(1), pairs(i)%impulse(2), inverse_mass, v)
      end do
      visit = 0
      do sweeps = 1, most_sweeps
         converged = .true.
         do k = 1, size(pairs)
            i = merge(k, size(pairs) + 1 - k, modulo(sweeps, 2) == 1)
            associate (pair => pairs(i))
               if (sweeps > 1 .and. max(max(woken(pair%node(1)), woken(pair%node(2))), &
                  max(woken(pair%node(3)), woken(pair%node(4)))) <= pair%visit) cycle
               visit = visit + 1
               pair%visit = visit
               call visit_pair(pair, inverse_mass, tolerance, v, woken, converged)
            end associate
         end do
         if (converged) return
      end do
      sweeps = most_sweeps
   end subroutine solve_pairs

   !> Solve one pair; tell its nodes if that has moved them.
   pure subroutine visit_pair(pair, inverse_mass, tolerance, v, woken, converged)
      type(pair_type), intent(inout) :: pair
      real(wp), intent(in), contiguous :: inverse_mass(:, :)
      real(wp), intent(in) :: tolerance
      real(wp), intent(inout), contiguous :: v(:, :)
      integer, intent(inout), contiguous :: woken(:)
      logical, intent(inout) :: converged

      real(wp) :: p(2), change(2)

      call solve_pair(pair, v, p)
      change(1) = p(1) - pair%impulse(1)
      change(2) = p(2) - pair%impulse(2)
      if (.not. max(abs(change(1)), abs(change(2))) > 0.0_wp) return
      pair%impulse(1) = p(1)
      pair%impulse(2) = p(2)
      call add_impulse(pair, change(1), change(2), inverse_mass, v)
      if (max(abs(change(1))*pair%compliance(1), abs(change(2))*pair%compliance(2)) &
         <= tolerance) return
      converged = .false.
      woken(pair%node(1)) = pair%visit
      woken(pair%node(2)) = pair%visit
      woken(pair%node(3)) = pair%visit
      woken(pair%node(4)) = pair%visit
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
