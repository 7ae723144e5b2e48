!> The boundary of the mesh: where parts can meet.
!>
!> A boundary edge has an element on its left and none on its right. Every boundary node has
!> exactly one edge in and one edge out, so that nodes and edges share one numbering: edge `i`
!> runs from boundary node `i` to boundary node `next(i)`.
module lithofrac_contact_surfaces
   use lithofrac_base_kinds, only: wp
   use lithofrac_base_status, only: bad_input, ok, set_failure, status_type
   use lithofrac_mesh_mesh, only: mesh_type
   implicit none
   private

   public :: list_edges, new_surfaces, offset, surfaces_type, tag_edges, update_edges
   public :: update_shape

   type :: surfaces_type
      integer :: n = 0                          !! boundary nodes, and as many edges
      integer, allocatable :: node(:)           !! (n) node of the mesh, ascending
      integer, allocatable :: next(:)           !! (n) boundary node at the end of edge i
      integer, allocatable :: prev(:)           !! (n) boundary node (and edge) before node i
      integer, allocatable :: tag(:)            !! (n) surface tag of edge i; the body by default
      real(wp), allocatable :: reference(:, :)  !! (2, n) reference positions [m]
      real(wp), allocatable :: u(:, :)          !! (2, n) displacement of now [m]
      real(wp), allocatable :: tangent(:, :)    !! (2, n) unit vector along edge i, of now
      real(wp), allocatable :: length(:)        !! (n) length of edge i, of now [m]
      real(wp) :: h = 0.0_wp                    !! shortest edge in the reference [m]
   end type surfaces_type

contains

   !> Find the boundary of a mesh; a node where two boundaries touch is refused.
   subroutine new_surfaces(surfaces, mesh, status)
      type(surfaces_type), intent(out) :: surfaces
      type(mesh_type), intent(in) :: mesh
      type(status_type), intent(out) :: status

      integer :: i, out_of(mesh%n_nodes), into(mesh%n_nodes), body(mesh%n_nodes), number
      integer :: local(mesh%n_nodes)

      call link_edges(mesh, out_of, into, body, status)
      if (status%code /= ok) return
      surfaces%n = count(out_of > 0)
      allocate (surfaces%node(surfaces%n), surfaces%next(surfaces%n), surfaces%prev(surfaces%n))
      number = 0
      do i = 1, mesh%n_nodes
         if (out_of(i) == 0) cycle
         number = number + 1
         surfaces%node(number) = i
         local(i) = number
      end do
      surfaces%next = local(out_of(surfaces%node))
      surfaces%prev = local(into(surfaces%node))
      surfaces%tag = body(surfaces%node)
      surfaces%reference = mesh%nodes(:, surfaces%node)
      allocate (surfaces%u(2, surfaces%n), surfaces%tangent(2, surfaces%n), source=0.0_wp)
      allocate (surfaces%length(surfaces%n))
      call update_shape(surfaces)
      surfaces%h = minval(surfaces%length)
   end subroutine new_surfaces

   !> End and start of the boundary edge that leaves and enters each node; 0 off the boundary.
   subroutine link_edges(mesh, out_of, into, body, status)
      type(mesh_type), intent(in) :: mesh
      integer, intent(out) :: out_of(:)
      integer, intent(out) :: into(:)
      integer, intent(out) :: body(:)        !! of the element left of the edge that leaves
      type(status_type), intent(out) :: status

      integer :: first(mesh%n_nodes + 1), end_of(3*mesh%n_elements), element, k, a, b
      character(len=100) :: words

      call list_edges(mesh, first, end_of)
      out_of = 0
      into = 0
      body = 0
      do element = 1, mesh%n_elements
         do k = 1, 3
            a = mesh%triangles(k, element)
            b = mesh%triangles(modulo(k, 3) + 1, element)
            if (any(end_of(first(b):first(b + 1) - 1) == a)) cycle
            if (out_of(a) /= 0 .or. into(b) /= 0) then
               write (words, "(a, i0, a)") "contact: node ", merge(a, b, out_of(a) /= 0), &
                  " joins two parts by a point only; give each part its own node"
               call set_failure(status, bad_input, trim(words))
               return
            end if
            out_of(a) = b
            into(b) = a
            body(a) = mesh%body(element)
         end do
      end do
   end subroutine link_edges

   !> Ends of the directed edges of all elements, sorted by the node where they start.
   subroutine list_edges(mesh, first, end_of)
      type(mesh_type), intent(in) :: mesh
      integer, intent(out) :: first(:)       !! (n_nodes + 1) into `end_of`
      integer, intent(out) :: end_of(:)      !! (3 n_elements)

      integer :: element, k, a, place(size(first))

      first = 0
      do element = 1, mesh%n_elements
         first(mesh%triangles(:, element) + 1) = first(mesh%triangles(:, element) + 1) + 1
      end do
      first(1) = 1
      do a = 1, mesh%n_nodes
         first(a + 1) = first(a + 1) + first(a)
      end do
      place = first
      do element = 1, mesh%n_elements
         do k = 1, 3
            a = mesh%triangles(k, element)
            end_of(place(a)) = mesh%triangles(modulo(k, 3) + 1, element)
            place(a) = place(a) + 1
         end do
      end do
   end subroutine list_edges

   !> Give some boundary edges a tag of their own.
   subroutine tag_edges(surfaces, edge, tag, status)
      type(surfaces_type), intent(inout) :: surfaces
      integer, intent(in) :: edge(:, :)      !! (2, n) nodes, material on the left
      integer, intent(in) :: tag
      type(status_type), intent(out) :: status

      character(len=100) :: words
      integer :: i, place

      do i = 1, size(edge, 2)
         place = findloc(surfaces%node, edge(1, i), dim=1)
         if (place > 0) then
            if (surfaces%node(surfaces%next(place)) == edge(2, i)) then
               surfaces%tag(place) = tag
               cycle
            end if
         end if
         write (words, "(a, i0, a, i0, a)") "contact: edge ", edge(1, i), "-", edge(2, i), &
            " is not on the boundary"
         call set_failure(status, bad_input, trim(words))
         return
      end do
   end subroutine tag_edges

   !> Tangents and lengths of the edges for the displacement of now.
   pure subroutine update_shape(surfaces)
      type(surfaces_type), intent(inout) :: surfaces

      integer :: i

      call update_edges(surfaces, [(i, i=1, surfaces%n)])
   end subroutine update_shape

   !> The same for some edges only.
   pure subroutine update_edges(surfaces, edge)
      type(surfaces_type), intent(inout) :: surfaces
      integer, intent(in), contiguous :: edge(:)

      integer :: i, j, k
      real(wp) :: x, y, length

      associate (reference => surfaces%reference, u => surfaces%u)
         do k = 1, size(edge)
            i = edge(k)
            j = surfaces%next(i)
            x = (reference(1, j) - reference(1, i)) + (u(1, j) - u(1, i))
            y = (reference(2, j) - reference(2, i)) + (u(2, j) - u(2, i))
            length = sqrt(x*x + y*y)
            surfaces%length(i) = length
            surfaces%tangent(1, i) = x/length
            surfaces%tangent(2, i) = y/length
         end do
      end associate
   end subroutine update_edges

   !> From boundary node `from` to boundary node `to` [m].
   !>
   !> Reference and displacement are subtracted apart: faces that touch keep a gap of exactly
   !> zero however far they stand from the origin.
   pure function offset(surfaces, to, from)
      type(surfaces_type), intent(in) :: surfaces
      integer, intent(in) :: to
      integer, intent(in) :: from
      real(wp) :: offset(2)

      offset = (surfaces%reference(:, to) - surfaces%reference(:, from)) &
         + (surfaces%u(:, to) - surfaces%u(:, from))
   end function offset

end module lithofrac_contact_surfaces
