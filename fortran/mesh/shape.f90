!> How good a triangle is: angles, size, and how far a wave may run in one time step.
!>
!> This module knows nothing of numbers of nodes or elements.
module lithofrac_mesh_shape
   use lithofrac_base_kinds, only: wp
   use lithofrac_mesh_mesh, only: triangle_area
   implicit none
   private

   public :: critical_length, mean_square_edge, smallest_angle

contains

   !> Critical time step of a free triangle times the P wave speed [m], exact.
   !>
   !> With lumped mass, omega^2 = (3/rho) max eig(D^1/2 B B^T D^1/2). B B^T depends on the sum G
   !> of the dyads of the three shape function gradients only; along the axes of G the problem
   !> falls apart into one shear mode and a 2 by 2 problem. tr G = L/(4 A^2) and
   !> det G = 3/(4 A^2), L the sum of the squared edges, so that with k = nu/(1 - nu)
   !>    length = 4 A/sqrt(3/2 max(L + sqrt(L^2 - 48 (1 - k^2) A^2), (1 - k) L)).
   !> Plane strain. The second branch, shear, leads for a negative Poisson's ratio only.
   pure function critical_length(corners, poisson) result(length)
      real(wp), intent(in) :: corners(2, 3)  !! positions [m]
      real(wp), intent(in) :: poisson        !! Poisson's ratio [-]
      real(wp) :: length

      real(wp) :: area, edges, k

      area = triangle_area(corners(:, 1), corners(:, 2), corners(:, 3))
      edges = 3.0_wp*mean_square_edge(corners)
      k = poisson/(1.0_wp - poisson)
      length = 4.0_wp*area/sqrt(1.5_wp*max((1.0_wp - k)*edges, &
         edges + sqrt(max(0.0_wp, edges**2 - 48.0_wp*(1.0_wp - k**2)*area**2))))
   end function critical_length

   !> Mean of the three squared edge lengths [m2].
   pure function mean_square_edge(corners) result(square)
      real(wp), intent(in) :: corners(2, 3)  !! [m]
      real(wp) :: square

      square = (sum((corners(:, 2) - corners(:, 1))**2) + sum((corners(:, 3) - corners(:, 2))**2) &
         + sum((corners(:, 1) - corners(:, 3))**2))/3.0_wp
   end function mean_square_edge

   !> Smallest of the three angles [rad].
   pure function smallest_angle(corners) result(angle)
      real(wp), intent(in) :: corners(2, 3)  !! [m], counter-clockwise
      real(wp) :: angle

      real(wp) :: double_area
      integer :: i, j, k

      double_area = 2.0_wp*triangle_area(corners(:, 1), corners(:, 2), corners(:, 3))
      angle = huge(1.0_wp)
      do i = 1, 3
         j = mod(i, 3) + 1
         k = mod(j, 3) + 1
         angle = min(angle, atan2(double_area, dot_product(corners(:, j) - corners(:, i), &
            corners(:, k) - corners(:, i))))
      end do
   end function smallest_angle

end module lithofrac_mesh_shape
