!> Boundary nodes that stand inside an element: a look without the memory of contact.
!>
!> Contact takes a node that is deeper behind a face than a hundredth of the shortest edge for one
!> that stands behind another face, and lets go of it. Whoever asks whether parts overlap must
!> therefore not ask its pairs. Here every boundary node is held against every element near it.
module lithofrac_contact_intruders
   use lithofrac_base_kinds, only: wp
   implicit none
   private

   public :: find_intruder, intruder_type

   !> The deepest of all.
   type :: intruder_type
      real(wp) :: depth = 0.0_wp                !! to the nearest edge of the element [m]
      integer :: node = 0                       !! 0: no node is inside an element
      integer :: element = 0
   end type intruder_type

   !> Boundary nodes in square cells, row by row.
   type :: cells_type
      real(wp) :: origin(2) = 0.0_wp            !! [m]
      real(wp) :: side = 0.0_wp                 !! [m]
      integer :: n(2) = 1                       !! columns, rows
      integer, allocatable :: first(:)          !! (n_cells + 1) into `node`
      integer, allocatable :: node(:)
   end type cells_type

contains

   !> Find the node that is deepest inside an element of which it is no corner.
   !>
   !> The depth is a lower bound: the nearest edge of the element may be one inside its part.
   pure subroutine find_intruder(boundary, x, triangles, alive, found)
      integer, intent(in) :: boundary(:)        !! nodes of the boundary
      real(wp), intent(in) :: x(:, :)           !! (2, n_nodes) positions of now, finite [m]
      integer, intent(in) :: triangles(:, :)    !! (3, n_elements)
      logical, intent(in) :: alive(:)           !! (>= n_elements) others do not count
      type(intruder_type), intent(out) :: found

      type(cells_type) :: cells
      real(wp) :: corner(2, 3), low(2), high(2), depth
      integer :: element, first(2), last(2), row, k

      if (size(boundary) == 0) return
      call fill_cells(cells, x, boundary)
      do element = 1, size(triangles, 2)
         if (.not. alive(element)) cycle
         corner = x(:, triangles(:, element))
         low = min(corner(:, 1), corner(:, 2), corner(:, 3))
         high = max(corner(:, 1), corner(:, 2), corner(:, 3))
         first = cell_of(cells, low)
         last = cell_of(cells, high)
         do row = first(2), last(2)
            do k = cells%first(number_of(cells, first(1), row)), &
               cells%first(number_of(cells, last(1), row) + 1) - 1
               associate (node => cells%node(k))
                  if (any(x(:, node) <= low) .or. any(x(:, node) >= high)) cycle
                  if (any(triangles(:, element) == node)) cycle
                  depth = depth_of(x(:, node), corner)
                  if (depth > found%depth) found = intruder_type(depth, node, element)
               end associate
            end do
         end do
      end do
   end subroutine find_intruder

   !> Counting sort of the boundary nodes into cells, about one node a cell.
   pure subroutine fill_cells(cells, x, boundary)
      type(cells_type), intent(out) :: cells
      real(wp), intent(in) :: x(:, :)
      integer, intent(in) :: boundary(:)

      real(wp) :: extent(2)
      integer, allocatable :: cell(:), place(:)
      integer :: i, at(2)

      cells%origin = minval(x(:, boundary), dim=2)
      extent = min(huge(1.0_wp), maxval(x(:, boundary), dim=2) - cells%origin)
      associate (n => real(size(boundary), wp))
         cells%side = max(sqrt(extent(1))*sqrt(extent(2))/sqrt(n), maxval(extent)/n, &
            tiny(1.0_wp))
      end associate
      cells%n = 1 + int(extent/cells%side)
      allocate (cell(size(boundary)), cells%node(size(boundary)))
      allocate (cells%first(product(cells%n) + 1), source=0)
      do i = 1, size(boundary)
         at = cell_of(cells, x(:, boundary(i)))
         cell(i) = number_of(cells, at(1), at(2))
         cells%first(cell(i) + 1) = cells%first(cell(i) + 1) + 1
      end do
      cells%first(1) = 1
      do i = 1, product(cells%n)
         cells%first(i + 1) = cells%first(i + 1) + cells%first(i)
      end do
      place = cells%first
      do i = 1, size(boundary)
         cells%node(place(cell(i))) = boundary(i)
         place(cell(i)) = place(cell(i)) + 1
      end do
   end subroutine fill_cells

   !> Column and row of a point; one outside counts to the nearest cell.
   pure function cell_of(cells, x) result(place)
      type(cells_type), intent(in) :: cells
      real(wp), intent(in) :: x(2)              !! [m]
      integer :: place(2)

      place = 1 + int(max(0.0_wp, min(cells%n - 1.0_wp, (x - cells%origin)/cells%side)))
   end function cell_of

   pure function number_of(cells, column, row) result(cell)
      type(cells_type), intent(in) :: cells
      integer, intent(in) :: column
      integer, intent(in) :: row
      integer :: cell

      cell = column + cells%n(1)*(row - 1)
   end function number_of

   !> Distance of a point from the nearest edge of a triangle [m], negative outside.
   pure function depth_of(x, corner) result(depth)
      real(wp), intent(in) :: x(2)
      real(wp), intent(in) :: corner(2, 3)      !! counter-clockwise
      real(wp) :: depth

      real(wp) :: along(2), arm(2)
      integer :: k

      depth = huge(1.0_wp)
      do k = 1, 3
         along = corner(:, modulo(k, 3) + 1) - corner(:, k)
         arm = x - corner(:, k)
         depth = min(depth, (along(1)*arm(2) - along(2)*arm(1))/norm2(along))
      end do
   end function depth_of

end module lithofrac_contact_intruders
