!> Sums in an order that no compiler and no processor changes.
!>
!> `omp simd reduction` adds in as many lanes as the target has, so that a sum has other bits with
!> another width of vectors, or without optimisation. Here the lanes are fixed.
module lithofrac_base_sums
   use lithofrac_base_kinds, only: wp
   implicit none
   private

   public :: ordered_sums

   integer, parameter :: lanes = 8

contains

   !> Sum of each column: every eighth number into a lane of its own, then the lanes pair by pair.
   !>
   !> All columns take a step at a time, so that no addition waits for the one before.
   pure function ordered_sums(n, columns, terms) result(totals)
      integer, intent(in) :: n
      integer, intent(in) :: columns
      real(wp), intent(in) :: terms(n, columns)
      real(wp) :: totals(columns)

      real(wp) :: lane(lanes, columns)
      integer :: i, k, whole

      lane = 0.0_wp
      whole = n - mod(n, lanes)
      do i = 0, whole - lanes, lanes
         do k = 1, columns
            lane(:, k) = lane(:, k) + terms(i + 1:i + lanes, k)
         end do
      end do
      do k = 1, columns
         do i = whole + 1, n
            lane(i - whole, k) = lane(i - whole, k) + terms(i, k)
         end do
      end do
      totals = ((lane(1, :) + lane(2, :)) + (lane(3, :) + lane(4, :))) &
         + ((lane(5, :) + lane(6, :)) + (lane(7, :) + lane(8, :)))
   end function ordered_sums

end module lithofrac_base_sums
