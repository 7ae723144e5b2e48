!> Block Gauss-Seidel over pairs: every pair is solved exactly in turn, until none changes.
!>
!> Sweeps go forward and backward in turn and start from the impulses of the step before. The
!> order of the pairs alone decides the bits of the result.
module lithofrac_contact_multipliers
   use lithofrac_base_kinds, only: wp
   use lithofrac_contact_friction, only: one_face, two_faces
   use lithofrac_contact_pairs, only: pair_type
   implicit none
   private

   public :: relative_velocity, solve_pairs

contains

   !> Find the impulses; velocities come out with them.
   pure subroutine solve_pairs(pairs, inverse_mass, tolerance, most_sweeps, v, sweeps, converged)
      type(pair_type), intent(inout) :: pairs(:)    !! `impulse` in: a guess, out: the solution
      real(wp), intent(in), contiguous :: inverse_mass(:, :)  !! (2, n) [1/kg]
      real(wp), intent(in) :: tolerance             !! change of a relative velocity [m/s]
      integer, intent(in) :: most_sweeps
      real(wp), intent(inout), contiguous :: v(:, :)  !! (2, n) without contact, then with [m/s]
      integer, intent(out) :: sweeps
      logical, intent(out) :: converged

      real(wp) :: change, p(2)
      integer :: i, k

      do i = 1, size(pairs)
         p = pairs(i)%impulse
         if (p(1)*p(1) + p(2)*p(2) > 0.0_wp) call add_impulse(pairs(i), p, inverse_mass, v)
      end do
      converged = .false.
      do sweeps = 1, most_sweeps
         change = 0.0_wp
         do k = 1, size(pairs)
            i = merge(k, size(pairs) + 1 - k, modulo(sweeps, 2) == 1)
            call solve_pair(pairs(i), v, p)
            if (.not. max(abs(p(1)), abs(p(2))) > 0.0_wp) cycle
            pairs(i)%impulse = pairs(i)%impulse + p
            call add_impulse(pairs(i), p, inverse_mass, v)
            change = max(change, abs(p(1))*pairs(i)%compliance(1), &
               abs(p(2))*pairs(i)%compliance(2))
         end do
         converged = change <= tolerance
         if (converged) return
      end do
      sweeps = most_sweeps
   end subroutine solve_pairs

   !> Change of the impulse of one pair when all others keep theirs.
   pure subroutine solve_pair(pair, v, change)
      type(pair_type), intent(in) :: pair
      real(wp), intent(in), contiguous :: v(:, :)
      real(wp), intent(out) :: change(2)            !! [N s]

      real(wp) :: d0(2)

      d0 = relative_velocity(pair, v) - pair%compliance*pair%impulse
      if (pair%n_faces == 1) then
         change = one_face(d0, pair%normal(:, 1), pair%bias(1), pair%friction, pair%compliance)
      else
         change = two_faces(d0, pair%normal, pair%bias, pair%friction, pair%compliance)
      end if
      change = change - pair%impulse
   end subroutine solve_pair

   !> Velocity of the node against what it may touch [m/s].
   pure function relative_velocity(pair, v) result(d)
      type(pair_type), intent(in) :: pair
      real(wp), intent(in), contiguous :: v(:, :)   !! (2, n) [m/s]
      real(wp) :: d(2)

      integer :: k

      d = 0.0_wp
      do k = 1, pair%n_nodes
         d(1) = d(1) + pair%weight(k)*v(1, pair%node(k))
         d(2) = d(2) + pair%weight(k)*v(2, pair%node(k))
      end do
   end function relative_velocity

   !> Change the velocities by an impulse of the pair.
   pure subroutine add_impulse(pair, p, inverse_mass, v)
      type(pair_type), intent(in) :: pair
      real(wp), intent(in) :: p(2)                  !! [N s]
      real(wp), intent(in), contiguous :: inverse_mass(:, :)
      real(wp), intent(inout), contiguous :: v(:, :)

      integer :: k

      do k = 1, pair%n_nodes
         associate (node => pair%node(k))
            v(1, node) = v(1, node) + inverse_mass(1, node)*(pair%weight(k)*p(1))
            v(2, node) = v(2, node) + inverse_mass(2, node)*(pair%weight(k)*p(2))
         end associate
      end do
   end subroutine add_impulse

end module lithofrac_contact_multipliers
