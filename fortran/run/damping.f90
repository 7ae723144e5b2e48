!> Damping that does not drag on steady loading.
!>
!> Plain mass damping (eq. 3) pulls on a body that moves or strains steadily. Here each body is
!> damped relative to the mass-weighted least-squares affine fit of its own velocity, which
!> adds no net force and no net moment. alpha = 2 fraction omega, with omega from a Rayleigh
!> quotient of the last increment.
module lithofrac_run_damping
   use lithofrac_base_kinds, only: wp
   implicit none
   private

   public :: affine_type, fit_affine, n_moments, rayleigh_frequency

   integer, parameter :: n_moments = 12  !! sums of `fit_affine`

   real(wp), parameter :: slender = 1.0e-12_wp  !! squared width over length of a body without one

   !> v(x) = velocity + gradient (x - centre).
   type :: affine_type
      real(wp) :: velocity(2) = 0.0_wp       !! [m/s]
      real(wp) :: centre(2) = 0.0_wp         !! [m]
      real(wp) :: gradient(2, 2) = 0.0_wp    !! [1/s]
   end type affine_type

contains

   !> Mass-weighted least-squares fit.
   pure function fit_affine(moments, about) result(affine)
      !> sums over nodes of m, m v (2), m x (2), m v1 x (2), m v2 x (2), m x1 x1, m x1 x2, m x2 x2
      real(wp), intent(in) :: moments(n_moments)
      !> point that x is measured from [m]; near the centre, or a body far away loses digits
      real(wp), intent(in) :: about(2)
      type(affine_type) :: affine

      real(wp) :: mass, arm(2), vx(2, 2), xx(3), determinant

      mass = moments(1)
      arm = moments(4:5)/mass
      affine%velocity = moments(2:3)/mass
      affine%centre = about + arm
      vx(1, :) = moments(6:7) - mass*affine%velocity(1)*arm
      vx(2, :) = moments(8:9) - mass*affine%velocity(2)*arm
      xx(1) = moments(10) - mass*arm(1)**2
      xx(2) = moments(11) - mass*arm(1)*arm(2)
      xx(3) = moments(12) - mass*arm(2)**2
      determinant = xx(1)*xx(3) - xx(2)**2
      ! nodes on a line tell no gradient
      if (determinant <= slender*(xx(1) + xx(3))**2) return
      affine%gradient(:, 1) = (vx(:, 1)*xx(3) - vx(:, 2)*xx(2))/determinant
      affine%gradient(:, 2) = (vx(:, 2)*xx(1) - vx(:, 1)*xx(2))/determinant
   end function fit_affine

   !> Frequency of the increment between two states of one body [1/s], not below `lowest`.
   pure function rayleigh_frequency(body, body_of_node, free_mass, du, df, lowest) result(omega)
      integer, intent(in) :: body
      integer, intent(in) :: body_of_node(:)       !! (n_nodes)
      real(wp), intent(in) :: free_mass(:, :)      !! (2, n_nodes) [kg]
      real(wp), intent(in) :: du(:, :)             !! (2, n_nodes) displacement increment [m]
      real(wp), intent(in) :: df(:, :)             !! (2, n_nodes) internal force increment [N]
      real(wp), intent(in) :: lowest               !! [1/s]
      real(wp) :: omega

      real(wp) :: stiffness, inertia
      integer :: node

      stiffness = 0.0_wp
      inertia = 0.0_wp
      do node = 1, size(body_of_node)
         if (body_of_node(node) /= body) cycle
         inertia = inertia + sum(free_mass(:, node)*du(:, node)**2)
         stiffness = stiffness + sum(du(:, node)*df(:, node), mask=free_mass(:, node) > 0.0_wp)
      end do
      omega = lowest
      if (stiffness > lowest**2*inertia) omega = sqrt(stiffness/inertia)
   end function rayleigh_frequency

end module lithofrac_run_damping
