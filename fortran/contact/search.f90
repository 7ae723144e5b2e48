!> Which boundary nodes and edges are near enough to meet soon.
!>
!> A list with a skin: it holds until some node has moved by a fifth of the skin. Edges are
!> sorted into square bins; each node asks the edges of its own bin. Lists come out in ascending
!> order, so nothing depends on threads or on the history of the list.
module lithofrac_contact_search
   use lithofrac_base_kinds, only: wp
   use lithofrac_contact_surfaces, only: offset, surfaces_type
   implicit none
   private

   public :: candidates_type, has_moved, list_candidates

   real(wp), parameter :: skin = 0.3_wp         !! over the shortest edge
   real(wp), parameter :: allowed_motion = 0.2_wp  !! of the skin

   type :: candidates_type
      logical :: listed = .false.
      real(wp), allocatable :: u(:, :)          !! (2, n) displacement that the list belongs to [m]
      integer, allocatable :: corner(:, :)      !! (2, n_corners) boundary nodes, first < second
      integer, allocatable :: edge(:, :)        !! (2, n_edges) boundary node, edge
      integer, allocatable :: corner_at(:, :)   !! (2, n_edges) corner of the node and either end
   end type candidates_type

   type :: bins_type
      real(wp) :: origin(2) = 0.0_wp            !! [m]
      real(wp) :: side = 0.0_wp                 !! [m]
      integer :: n(2) = 0
      integer, allocatable :: first(:)          !! (n_bins + 1) into `edge`
      integer, allocatable :: edge(:)           !! edges whose box and skin touch a bin, ascending
   end type bins_type

contains

   !> Has one of these nodes moved too far for the list?
   pure function has_moved(candidates, surfaces, first, last) result(moved)
      type(candidates_type), intent(in) :: candidates
      type(surfaces_type), intent(in) :: surfaces
      integer, intent(in) :: first
      integer, intent(in) :: last
      logical :: moved

      real(wp) :: way, limit
      integer :: i

      moved = .false.
      limit = (allowed_motion*skin*surfaces%h)**2
      do i = first, last
         way = (surfaces%u(1, i) - candidates%u(1, i))**2 &
            + (surfaces%u(2, i) - candidates%u(2, i))**2
         if (.not. way <= limit) moved = .true.
      end do
   end function has_moved

   !> List the pairs within the skin of the positions of now.
   subroutine list_candidates(candidates, surfaces)
      type(candidates_type), intent(out) :: candidates
      type(surfaces_type), intent(in) :: surfaces

      type(bins_type) :: bins
      integer :: n_corners, n_edges

      call fill_bins(bins, surfaces)
      candidates%listed = .true.
      candidates%u = surfaces%u
      allocate (candidates%corner(2, 0), candidates%edge(2, 0))
      call scan(candidates, surfaces, bins, n_corners, n_edges, keep=.false.)
      deallocate (candidates%corner, candidates%edge)
      allocate (candidates%corner(2, n_corners), candidates%edge(2, n_edges))
      call scan(candidates, surfaces, bins, n_corners, n_edges, keep=.true.)
      call join_corners(candidates, surfaces)
   end subroutine list_candidates

   !> Ask the edges in the bin of every node; counts, and keeps when told.
   subroutine scan(candidates, surfaces, bins, n_corners, n_edges, keep)
      type(candidates_type), intent(inout) :: candidates
      type(surfaces_type), intent(in) :: surfaces
      type(bins_type), intent(in) :: bins
      integer, intent(out) :: n_corners
      integer, intent(out) :: n_edges
      logical, intent(in) :: keep

      integer :: i, j, k, bin

      n_corners = 0
      n_edges = 0
      do i = 1, surfaces%n
         bin = bin_of(bins, surfaces%reference(:, i) + surfaces%u(:, i))
         do k = bins%first(bin), bins%first(bin + 1) - 1
            j = bins%edge(k)
            if (j == i) cycle
            if (j > i .and. j /= surfaces%next(i) .and. j /= surfaces%prev(i)) then
               if (maxval(abs(offset(surfaces, i, j))) <= skin*surfaces%h) then
                  n_corners = n_corners + 1
                  if (keep) candidates%corner(:, n_corners) = [i, j]
               end if
            end if
            if (surfaces%next(j) == i) cycle
            if (.not. is_near(surfaces, i, j)) cycle
            n_edges = n_edges + 1
            if (keep) candidates%edge(:, n_edges) = [i, j]
         end do
      end do
   end subroutine scan

   !> Is node i within the skin of edge j?
   pure function is_near(surfaces, i, j)
      type(surfaces_type), intent(in) :: surfaces
      integer, intent(in) :: i
      integer, intent(in) :: j
      logical :: is_near

      real(wp) :: arm(2), along, across

      arm = offset(surfaces, i, j)
      along = dot_product(arm, surfaces%tangent(:, j))
      across = arm(1)*surfaces%tangent(2, j) - arm(2)*surfaces%tangent(1, j)
      is_near = abs(across) <= skin*surfaces%h .and. along >= -skin*surfaces%h &
         .and. along <= surfaces%length(j) + skin*surfaces%h
   end function is_near

   !> Tell each node-edge pair which corners the node makes with the ends of the edge.
   subroutine join_corners(candidates, surfaces)
      type(candidates_type), intent(inout) :: candidates
      type(surfaces_type), intent(in) :: surfaces

      integer :: first(surfaces%n + 1), i, k

      first = 0
      do k = 1, size(candidates%corner, 2)
         i = candidates%corner(1, k)
         first(i + 1) = first(i + 1) + 1
      end do
      first(1) = 1
      do i = 1, surfaces%n
         first(i + 1) = first(i + 1) + first(i)
      end do
      allocate (candidates%corner_at(2, size(candidates%edge, 2)))
      do k = 1, size(candidates%edge, 2)
         associate (node => candidates%edge(1, k), edge => candidates%edge(2, k))
            candidates%corner_at(1, k) = corner_number(candidates, first, node, edge)
            candidates%corner_at(2, k) = corner_number(candidates, first, node, &
               surfaces%next(edge))
         end associate
      end do
   end subroutine join_corners

   !> Number of the corner of two boundary nodes; 0 when they make none.
   pure function corner_number(candidates, first, i, j) result(number)
      type(candidates_type), intent(in) :: candidates
      integer, intent(in) :: first(:)   !! (n + 1) into the corners, by their first node
      integer, intent(in) :: i
      integer, intent(in) :: j
      integer :: number

      associate (low => min(i, j), high => max(i, j))
         do number = first(low), first(low + 1) - 1
            if (candidates%corner(2, number) == high) return
         end do
      end associate
      number = 0
   end function corner_number

   !> Counting sort of the edges into bins; an edge enters every bin that its box touches.
   subroutine fill_bins(bins, surfaces)
      type(bins_type), intent(out) :: bins
      type(surfaces_type), intent(in) :: surfaces

      real(wp) :: extent(2)
      integer :: j, column, row, bin, range(2, 2), pass
      integer, allocatable :: place(:)

      associate (x => surfaces%reference, u => surfaces%u)
         bins%origin = minval(x + u, dim=2)
         extent = maxval(x + u, dim=2) - bins%origin
      end associate
      bins%side = max(2.0_wp*sum(surfaces%length)/surfaces%n, &
         sqrt(extent(1)*extent(2)/(4.0_wp*surfaces%n)), maxval(extent)/(4.0_wp*surfaces%n))
      bins%n = 1 + int(extent/bins%side)
      allocate (bins%first(product(bins%n) + 1), source=0)
      do pass = 1, 2
         do j = 1, surfaces%n
            range = bins_of_edge(bins, surfaces, j)
            do row = range(2, 1), range(2, 2)
               do column = range(1, 1), range(1, 2)
                  bin = column + bins%n(1)*(row - 1)
                  if (pass == 1) then
                     bins%first(bin + 1) = bins%first(bin + 1) + 1
                  else
                     bins%edge(place(bin)) = j
                     place(bin) = place(bin) + 1
                  end if
               end do
            end do
         end do
         if (pass == 2) exit
         bins%first(1) = 1
         do bin = 1, product(bins%n)
            bins%first(bin + 1) = bins%first(bin + 1) + bins%first(bin)
         end do
         place = bins%first
         allocate (bins%edge(bins%first(size(bins%first)) - 1))
      end do
   end subroutine fill_bins

   !> Columns (first row of the result) and rows of bins that an edge and its skin touch.
   pure function bins_of_edge(bins, surfaces, j) result(range)
      type(bins_type), intent(in) :: bins
      type(surfaces_type), intent(in) :: surfaces
      integer, intent(in) :: j
      integer :: range(2, 2)

      real(wp) :: a(2), b(2), reach

      reach = 2.0_wp*skin*surfaces%h
      a = surfaces%reference(:, j) + surfaces%u(:, j)
      associate (k => surfaces%next(j))
         b = surfaces%reference(:, k) + surfaces%u(:, k)
      end associate
      range(:, 1) = 1 + int((min(a, b) - reach - bins%origin)/bins%side)
      range(:, 2) = 1 + int((max(a, b) + reach - bins%origin)/bins%side)
      range(:, 1) = max(1, min(bins%n, range(:, 1)))
      range(:, 2) = max(1, min(bins%n, range(:, 2)))
   end function bins_of_edge

   !> Bin of a point inside the box of all boundary nodes.
   pure function bin_of(bins, x) result(bin)
      type(bins_type), intent(in) :: bins
      real(wp), intent(in) :: x(2)
      integer :: bin

      integer :: place(2)

      place = max(1, min(bins%n, 1 + int((x - bins%origin)/bins%side)))
      bin = place(1) + bins%n(1)*(place(2) - 1)
   end function bin_of

end module lithofrac_contact_search
