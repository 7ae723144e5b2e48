!> Strength that changes with inelastic strain: piecewise-linear tables.
!>
!> A table gives cohesion, friction or dilation as a function of the effective
!> plastic strain (Klerck 2004, Table 1). Outside its range the table is flat.
module lithofrac_material_table
   use lithofrac_base_kinds, only: wp
   use lithofrac_base_status, only: bad_input, set_failure, status_type
   implicit none
   private

   public :: table_type, new_table, table_segment, value_and_slope
   public :: max_knots

   integer, parameter :: max_knots = 64  !! room for knots; Table 1 has eight

   !> Piecewise-linear y(x), flat beyond both ends. Segment i runs from knot i to i + 1;
   !> segment 0 lies below the first knot, segment n beyond the last.
   type :: table_type
      integer :: n = 0                        !! knots in use
      real(wp) :: x(max_knots) = 0.0_wp       !! strictly increasing abscissas [-]
      real(wp) :: y(0:max_knots) = 0.0_wp     !! value where segment i starts, unit of the owner
      real(wp) :: slope(0:max_knots) = 0.0_wp !! dy/dx on segment i
      real(wp) :: origin(0:max_knots) = 0.0_wp !! abscissa where segment i starts
   end type table_type

contains

   !> Build a table, or fail with words if the numbers make none.
   pure subroutine new_table(table, x, y, status)
      type(table_type), intent(out) :: table
      real(wp), intent(in) :: x(:)             !! (n) abscissas [-]
      real(wp), intent(in) :: y(:)             !! (n) values, same length as x
      type(status_type), intent(out) :: status

      integer :: n

      n = size(x)
      if (n == 0 .or. n /= size(y)) then
         call set_failure(status, bad_input, "table: x and y need equal, nonzero length")
      else if (n > max_knots) then
         call set_failure(status, bad_input, "table: more than 64 knots")
      else if (.not. all(abs(x) <= huge(x)) .or. .not. all(abs(y) <= huge(y))) then
         call set_failure(status, bad_input, "table: every number must be finite")
      else if (any(x(2:) <= x(:n - 1))) then
         call set_failure(status, bad_input, "table: x must increase strictly")
      else
         table%n = n
         table%x(:n) = x
         table%y(0) = y(1)
         table%y(1:n) = y
         table%origin(0) = x(1)
         table%origin(1:n) = x
         table%slope(1:n - 1) = (y(2:) - y(:n - 1))/(x(2:) - x(:n - 1))
      end if
   end subroutine new_table

   !> Segment that holds `x`; a knot belongs to the segment on its right.
   pure function table_segment(table, x) result(segment)
      type(table_type), intent(in) :: table
      real(wp), intent(in) :: x
      integer :: segment

      do segment = 0, table%n - 1
         if (x < table%x(segment + 1)) return
      end do
      segment = table%n
   end function table_segment

   !> y and dy/dx at `x`; at a kink the slope is that of the segment to the right.
   pure subroutine value_and_slope(table, x, y, dydx)
      type(table_type), intent(in) :: table
      real(wp), intent(in) :: x
      real(wp), intent(out) :: y
      real(wp), intent(out) :: dydx

      integer :: i

      i = table_segment(table, x)
      dydx = table%slope(i)
      y = table%y(i) + dydx*(x - table%origin(i))
   end subroutine value_and_slope

end module lithofrac_material_table
