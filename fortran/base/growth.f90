!> Arrays that grow by doubling, so that adding one entry at a time costs a constant time each.
!>
!> Capacity is the size of the last dimension; the count is the owner's. What has not been used
!> is zero (false).
module lithofrac_base_growth
   use lithofrac_base_kinds, only: wp
   implicit none
   private

   public :: append, reserve

   integer, parameter :: smallest = 8  !! first capacity

   !> Make room for at least so many entries; what is there stays.
   interface reserve
      module procedure :: reserve_integers
      module procedure :: reserve_integer_columns
      module procedure :: reserve_logicals
      module procedure :: reserve_reals
      module procedure :: reserve_real_columns
   end interface reserve

   !> Add one entry (or column) behind the first `n`, and count it.
   interface append
      module procedure :: append_integer
      module procedure :: append_integer_column
      module procedure :: append_real
   end interface append

contains

   pure subroutine reserve_integers(array, least)
      integer, allocatable, intent(inout) :: array(:)
      integer, intent(in) :: least

      integer, allocatable :: larger(:)

      if (.not. allocated(array)) allocate (array(0))
      if (size(array) >= least) return
      allocate (larger(max(least, 2*size(array), smallest)), source=0)
      larger(:size(array)) = array
      call move_alloc(larger, array)
   end subroutine reserve_integers

   !> `rows` is needed only where nothing has been allocated yet.
   pure subroutine reserve_integer_columns(array, least, rows)
      integer, allocatable, intent(inout) :: array(:, :)
      integer, intent(in) :: least
      integer, intent(in), optional :: rows

      integer, allocatable :: larger(:, :)

      if (.not. allocated(array) .and. present(rows)) allocate (array(rows, 0))
      if (size(array, 2) >= least) return
      allocate (larger(size(array, 1), max(least, 2*size(array, 2), smallest)), source=0)
      larger(:, :size(array, 2)) = array
      call move_alloc(larger, array)
   end subroutine reserve_integer_columns

   pure subroutine reserve_logicals(array, least)
      logical, allocatable, intent(inout) :: array(:)
      integer, intent(in) :: least

      logical, allocatable :: larger(:)

      if (.not. allocated(array)) allocate (array(0))
      if (size(array) >= least) return
      allocate (larger(max(least, 2*size(array), smallest)), source=.false.)
      larger(:size(array)) = array
      call move_alloc(larger, array)
   end subroutine reserve_logicals

   pure subroutine reserve_reals(array, least)
      real(wp), allocatable, intent(inout) :: array(:)
      integer, intent(in) :: least

      real(wp), allocatable :: larger(:)

      if (.not. allocated(array)) allocate (array(0))
      if (size(array) >= least) return
      allocate (larger(max(least, 2*size(array), smallest)), source=0.0_wp)
      larger(:size(array)) = array
      call move_alloc(larger, array)
   end subroutine reserve_reals

   pure subroutine reserve_real_columns(array, least)
      real(wp), allocatable, intent(inout) :: array(:, :)
      integer, intent(in) :: least

      real(wp), allocatable :: larger(:, :)

      if (size(array, 2) >= least) return
      allocate (larger(size(array, 1), max(least, 2*size(array, 2), smallest)), source=0.0_wp)
      larger(:, :size(array, 2)) = array
      call move_alloc(larger, array)
   end subroutine reserve_real_columns

   pure subroutine append_integer(array, n, entry)
      integer, allocatable, intent(inout) :: array(:)
      integer, intent(inout) :: n
      integer, intent(in) :: entry

      call reserve(array, n + 1)
      n = n + 1
      array(n) = entry
   end subroutine append_integer

   pure subroutine append_integer_column(array, n, column)
      integer, allocatable, intent(inout) :: array(:, :)
      integer, intent(inout) :: n
      integer, intent(in) :: column(:)

      call reserve(array, n + 1, size(column))
      n = n + 1
      array(:, n) = column
   end subroutine append_integer_column

   pure subroutine append_real(array, n, entry)
      real(wp), allocatable, intent(inout) :: array(:)
      integer, intent(inout) :: n
      real(wp), intent(in) :: entry

      call reserve(array, n + 1)
      n = n + 1
      array(n) = entry
   end subroutine append_real

end module lithofrac_base_growth
