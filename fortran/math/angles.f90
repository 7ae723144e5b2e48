!> Sine and cosine of angles in the first quadrant, in one pass over several of them.
!>
!> Series of the half angle, doubled: a few rounding errors off, exact at zero, the same bits on
!> every machine, and without the library call that keeps a loop from being vectorised.
module lithofrac_math_angles
   use lithofrac_base_kinds, only: wp
   implicit none
   private

   public :: sine_cosine

contains

   !> Sine and cosine of `n` angles from 0 to 90 degrees. Beyond they lose digits, no more.
   pure subroutine sine_cosine(n, angle, sine, cosine)
      integer, intent(in) :: n
      real(wp), intent(in) :: angle(n)   !! [rad]
      real(wp), intent(out) :: sine(n)
      real(wp), intent(out) :: cosine(n)

      integer :: i, k
      !> 1/3!, 1/5!, ... with the signs of the series of the sine; the next term is below 1e-19
      real(wp), parameter :: odd(8) = [(real((-1)**k, wp)/gamma(real(2*k + 2, wp)), k=1, 8)]
      !> 1/2!, 1/4!, ... of the cosine less one
      real(wp), parameter :: even(8) = [(real((-1)**k, wp)/gamma(real(2*k + 1, wp)), k=1, 8)]
      real(wp) :: half, q, qq, c, s

      ! Terms in pairs, and pairs of pairs: half as many that wait for each other.
      !$omp simd private(half, q, qq, c, s)
      do i = 1, n
         half = 0.5_wp*angle(i)
         q = half*half
         qq = q*q
         s = half + half*q*(odd(1) + q*odd(2) + qq*(odd(3) + q*odd(4) &
            + qq*(odd(5) + q*odd(6) + qq*(odd(7) + q*odd(8)))))
         c = q*(even(1) + q*even(2) + qq*(even(3) + q*even(4) &
            + qq*(even(5) + q*even(6) + qq*(even(7) + q*even(8)))))
         sine(i) = 2.0_wp*s + 2.0_wp*s*c
         cosine(i) = 1.0_wp - 2.0_wp*s*s
      end do
   end subroutine sine_cosine

end module lithofrac_math_angles
