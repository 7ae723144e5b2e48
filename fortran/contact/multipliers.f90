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

   public :: add_impulse, relative_velocity, solve_pairs

contains

   !> Find the impulses; velocities come out with them.
   pure subroutine solve_pairs(pairs, inverse_mass, tolerance, most_sweeps, v, sweeps, converged)
      type(pair_type), intent(inout) :: pairs(:)    !! `impulse` in: a guess, out: the solution
      real(wp), intent(in) :: inverse_mass(:, :)    !! (2, n) [1/kg]
      real(wp), intent(in) :: tolerance             !! change of a relative velocity [m/s]
      integer, intent(in) :: most_sweeps
      real(wp), intent(inout) :: v(:, :)            !! (2, n) in: without contact, out: with [m/s]
      integer, intent(out) :: sweeps
      logical, intent(out) :: converged

      real(wp) :: change, p(2)
      integer :: i, k

      do i = 1, size(pairs)
         if (all(abs(pairs(i)%impulse) <= 0.0_wp)) cycle
         call add_impulse(pairs(i), pairs(i)%impulse, inverse_mass, v)
      end do
      converged = .false.
      do sweeps = 1, most_sweeps
         change = 0.0_wp
         do k = 1, size(pairs)
            i = merge(k, size(pairs) + 1 - k, modulo(sweeps, 2) == 1)
            p = solution(pairs(i), v) - pairs(i)%impulse
            if (.not. any(abs(p) > 0.0_wp)) cycle
            pairs(i)%impulse = pairs(i)%impulse + p
            call add_impulse(pairs(i), p, inverse_mass, v)
            change = max(change, maxval(abs(p)*pairs(i)%compliance))
         end do
         converged = change <= tolerance
         if (converged) return
      end do
      sweeps = most_sweeps
   end subroutine solve_pairs

   !> Impulse of one pair when all others keep theirs.
   pure function solution(pair, v) result(p)
      type(pair_type), intent(in) :: pair
      real(wp), intent(in) :: v(:, :)
      real(wp) :: p(2)

      real(wp) :: d0(2)

      d0 = relative_velocity(pair, v) - pair%compliance*pair%impulse
      if (pair%n_faces == 1) then
         p = one_face(d0, pair%normal(:, 1), pair%bias(1), pair%friction, pair%compliance)
      else
         p = two_faces(d0, pair%normal, pair%bias, pair%friction, pair%compliance)
      end if
   end function solution

   !> Velocity of the node against what it may touch [m/s].
   pure function relative_velocity(pair, v) result(d)
      type(pair_type), intent(in) :: pair
      real(wp), intent(in) :: v(:, :)
      real(wp) :: d(2)

      integer :: k

      d = 0.0_wp
      do k = 1, pair%n_nodes
         d = d + pair%weight(k)*v(:, pair%node(k))
      end do
   end function relative_velocity

   !> Change the velocities by an impulse of the pair.
   pure subroutine add_impulse(pair, p, inverse_mass, v)
      type(pair_type), intent(in) :: pair
      real(wp), intent(in) :: p(2)                  !! [N s]
      real(wp), intent(in) :: inverse_mass(:, :)
      real(wp), intent(inout) :: v(:, :)

      integer :: k

      do k = 1, pair%n_nodes
         associate (node => pair%node(k))
            v(:, node) = v(:, node) + inverse_mass(:, node)*(pair%weight(k)*p)
         end associate
      end do
   end subroutine add_impulse

end module lithofrac_contact_multipliers
