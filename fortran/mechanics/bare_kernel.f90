!> The least that an explicit elastic step can do: a yardstick for the benchmark, nothing else.
!>
!> Green-Naghdi in rate form with stored stress, central differences, no material law, no
!> boundary, no ledger; the same chunks, gather and scatter as the real step.
module lithofrac_mechanics_bare_kernel
   use lithofrac_base_kinds, only: wp
   use lithofrac_mechanics_chunks, only: chunks_type, width
   implicit none
   private

   public :: bare_steps

contains

   !> Take `n_steps` bare elastic steps on one thread.
   subroutine bare_steps(chunks, lame, shear, inverse_mass, dt, n_steps, x, v)
      type(chunks_type), intent(in) :: chunks
      real(wp), intent(in) :: lame                              !! [Pa]
      real(wp), intent(in) :: shear                             !! [Pa]
      real(wp), intent(in), contiguous :: inverse_mass(:)       !! (n_nodes) [1/kg]
      real(wp), intent(in) :: dt                                !! [s]
      integer, intent(in) :: n_steps
      real(wp), intent(inout), contiguous :: x(:, :)            !! (2, n_nodes) positions [m]
      real(wp), intent(inout), contiguous :: v(:, :)            !! (2, n_nodes) [m/s]

      real(wp), allocatable :: stress(:, :, :), f(:, :)
      integer :: step, chunk, node

      allocate (stress(width, 4, chunks%n_chunks), source=0.0_wp)
      allocate (f(2, size(x, 2)), source=0.0_wp)
      do step = 1, n_steps
         do chunk = 1, chunks%n_chunks
            call bare_chunk(chunks%node(:, :, chunk), chunks%gradient(:, :, chunk), lame, shear, &
               dt, x, v, stress(:, :, chunk), f)
         end do
         do node = 1, size(x, 2)
            v(1, node) = v(1, node) + dt*inverse_mass(node)*f(1, node)
            v(2, node) = v(2, node) + dt*inverse_mass(node)*f(2, node)
            x(1, node) = x(1, node) + dt*v(1, node)
            x(2, node) = x(2, node) + dt*v(2, node)
            f(:, node) = 0.0_wp
         end do
      end do
   end subroutine bare_steps

   pure subroutine bare_chunk(node, gradient, lame, shear, dt, x, v, s, f)
      integer, intent(in) :: node(width, 3)
      real(wp), intent(in) :: gradient(width, 4)
      real(wp), intent(in) :: lame
      real(wp), intent(in) :: shear
      real(wp), intent(in) :: dt
      real(wp), intent(in), contiguous :: x(:, :)
      real(wp), intent(in), contiguous :: v(:, :)
      real(wp), intent(inout) :: s(width, 4)                    !! unrotated stress [Pa]
      real(wp), intent(inout), contiguous :: f(:, :)

      real(wp) :: d(width, 8), p(width, 4)
      real(wp) :: id, l11, l12, l21, l22, d12, c, t, h, q, cc, e11, e22, e12, tr, r11, r22, r12
      integer :: i

      do i = 1, width
         d(i, 1) = x(1, node(i, 2)) - x(1, node(i, 1))
         d(i, 2) = x(2, node(i, 2)) - x(2, node(i, 1))
         d(i, 3) = x(1, node(i, 3)) - x(1, node(i, 1))
         d(i, 4) = x(2, node(i, 3)) - x(2, node(i, 1))
         d(i, 5) = v(1, node(i, 2)) - v(1, node(i, 1))
         d(i, 6) = v(2, node(i, 2)) - v(2, node(i, 1))
         d(i, 7) = v(1, node(i, 3)) - v(1, node(i, 1))
         d(i, 8) = v(2, node(i, 3)) - v(2, node(i, 1))
      end do
      !$omp simd private(id, l11, l12, l21, l22, d12, c, t, h, q, cc, e11, e22, e12, tr) &
      !$omp& private(r11, r22, r12)
      do i = 1, width
         c = d(i, 1)*gradient(i, 1) + d(i, 3)*gradient(i, 3) + d(i, 2)*gradient(i, 2) &
            + d(i, 4)*gradient(i, 4)
         t = d(i, 2)*gradient(i, 1) + d(i, 4)*gradient(i, 3) - d(i, 1)*gradient(i, 2) &
            - d(i, 3)*gradient(i, 4)
         id = dt/(d(i, 1)*d(i, 4) - d(i, 3)*d(i, 2) + tiny(id))
         l11 = (d(i, 5)*d(i, 4) - d(i, 7)*d(i, 2))*id
         l12 = (d(i, 7)*d(i, 1) - d(i, 5)*d(i, 3))*id
         l21 = (d(i, 6)*d(i, 4) - d(i, 8)*d(i, 2))*id
         l22 = (d(i, 8)*d(i, 1) - d(i, 6)*d(i, 3))*id
         d12 = 0.5_wp*(l12 + l21)
         h = 1.0_wp/sqrt(c*c + t*t + tiny(h))
         c = c*h
         t = t*h
         q = 2.0_wp*c*t*d12
         cc = c*c
         e11 = cc*l11 + (1.0_wp - cc)*l22 + q
         tr = l11 + l22
         e22 = tr - e11
         e12 = c*t*(l22 - l11) + (2.0_wp*cc - 1.0_wp)*d12
         s(i, 1) = s(i, 1) + lame*tr + 2.0_wp*shear*e11
         s(i, 2) = s(i, 2) + lame*tr + 2.0_wp*shear*e22
         s(i, 3) = s(i, 3) + lame*tr
         s(i, 4) = s(i, 4) + 2.0_wp*shear*e12
         q = 2.0_wp*c*t*s(i, 4)
         r11 = cc*s(i, 1) + (1.0_wp - cc)*s(i, 2) - q
         r22 = s(i, 1) + s(i, 2) - r11
         r12 = c*t*(s(i, 1) - s(i, 2)) + (2.0_wp*cc - 1.0_wp)*s(i, 4)
         p(i, 1) = -0.5_wp*(r11*d(i, 4) - r12*d(i, 3))
         p(i, 2) = -0.5_wp*(r12*d(i, 4) - r22*d(i, 3))
         p(i, 3) = -0.5_wp*(-r11*d(i, 2) + r12*d(i, 1))
         p(i, 4) = -0.5_wp*(-r12*d(i, 2) + r22*d(i, 1))
      end do
      do i = 1, width
         f(1, node(i, 2)) = f(1, node(i, 2)) + p(i, 1)
         f(2, node(i, 2)) = f(2, node(i, 2)) + p(i, 2)
         f(1, node(i, 3)) = f(1, node(i, 3)) + p(i, 3)
         f(2, node(i, 3)) = f(2, node(i, 3)) + p(i, 4)
         f(1, node(i, 1)) = f(1, node(i, 1)) - (p(i, 1) + p(i, 3))
         f(2, node(i, 1)) = f(2, node(i, 1)) - (p(i, 2) + p(i, 4))
      end do
   end subroutine bare_chunk

end module lithofrac_mechanics_bare_kernel
