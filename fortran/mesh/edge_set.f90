!> Edges of the boundary that something is attached to: they follow the mesh when it cracks.
!>
!> An edge is kept as element and side, because its nodes may be replaced by copies and its
!> element may be cut.
module lithofrac_mesh_edge_set
   use lithofrac_base_growth, only: append
   use lithofrac_base_kinds, only: wp
   use lithofrac_mesh_mesh, only: mesh_type
   use lithofrac_mesh_rings, only: fan_of_node, fan_type
   use lithofrac_mesh_topology, only: next_corner, topology_type
   implicit none
   private

   public :: edge_nodes, find_edges, follow_edges

   real(wp), parameter :: on_line = 1.0e-9_wp  !! distance from a line, over its length

contains

   !> Element and side of boundary edges given by their nodes; 0 where there is none.
   pure function find_edges(mesh, topology, nodes) result(edge)
      type(mesh_type), intent(in) :: mesh
      type(topology_type), intent(in) :: topology
      integer, intent(in) :: nodes(:, :)          !! (2, n) material on the left
      integer :: edge(2, size(nodes, 2))

      type(fan_type) :: fan
      integer :: i, k

      edge = 0
      do i = 1, size(nodes, 2)
         call fan_of_node(mesh, topology, nodes(1, i), fan)
         do k = 1, fan%n
            if (fan%rim(k) /= nodes(2, i)) cycle
            if (topology%neighbour(fan%corner(k), fan%element(k)) /= 0) cycle
            edge(:, i) = [fan%element(k), fan%corner(k)]
         end do
      end do
   end function find_edges

   !> Nodes of edges.
   pure function edge_nodes(mesh, edge) result(nodes)
      type(mesh_type), intent(in) :: mesh
      integer, intent(in) :: edge(:, :)           !! (2, n) element, side
      integer :: nodes(2, size(edge, 2))

      integer :: i

      do i = 1, size(edge, 2)
         nodes(1, i) = mesh%triangles(edge(2, i), edge(1, i))
         nodes(2, i) = mesh%triangles(next_corner(edge(2, i)), edge(1, i))
      end do
   end function edge_nodes

   !> Replace edges of elements that have been cut by those of the pieces, in their order.
   pure subroutine follow_edges(mesh, topology, element_parent, first_new, edge, source)
      type(mesh_type), intent(in) :: mesh
      type(topology_type), intent(in) :: topology
      integer, intent(in) :: element_parent(:)          !! (new) element each one is cut from
      integer, intent(in) :: first_new                  !! number of the first new element
      integer, allocatable, intent(inout) :: edge(:, :) !! (2, n) element, side
      integer, allocatable, intent(out) :: source(:)    !! (n afterwards) place before

      integer, allocatable :: followed(:, :)
      integer :: i, k, n, n_source, piece, old(2)

      source = [(i, i=1, size(edge, 2))]
      if (size(element_parent) == 0) return
      n = 0
      n_source = 0
      deallocate (source)
      allocate (source(0), followed(2, 0))
      do i = 1, size(edge, 2)
         if (topology%alive(edge(1, i))) then
            call append(followed, n, edge(:, i))
            call append(source, n_source, i)
            cycle
         end if
         old = reshape(edge_nodes(mesh, edge(:, i:i)), [2])
         do piece = first_new, first_new + size(element_parent) - 1
            if (.not. topology%alive(piece)) cycle
            if (.not. descends(piece, edge(1, i))) cycle
            do k = 1, 3
               if (topology%neighbour(k, piece) /= 0) cycle
               if (.not. lies_on(mesh, old, mesh%triangles(k, piece))) cycle
               if (.not. lies_on(mesh, old, mesh%triangles(next_corner(k), piece))) cycle
               call append(followed, n, [piece, k])
               call append(source, n_source, i)
            end do
         end do
      end do
      edge = followed(:, :n)
      source = source(:n)

   contains

      pure function descends(piece, ancestor) result(yes)
         integer, intent(in) :: piece
         integer, intent(in) :: ancestor
         logical :: yes

         integer :: element

         element = piece
         do while (element >= first_new)
            element = element_parent(element - first_new + 1)
            yes = element == ancestor
            if (yes) return
         end do
         yes = .false.
      end function descends

   end subroutine follow_edges

   !> Does a node lie on the line through two others, in the reference?
   pure function lies_on(mesh, ends, node) result(yes)
      type(mesh_type), intent(in) :: mesh
      integer, intent(in) :: ends(2)
      integer, intent(in) :: node
      logical :: yes

      real(wp) :: along(2), arm(2)

      along = mesh%nodes(:, ends(2)) - mesh%nodes(:, ends(1))
      arm = mesh%nodes(:, node) - mesh%nodes(:, ends(1))
      yes = abs(along(1)*arm(2) - along(2)*arm(1)) <= on_line*dot_product(along, along)
   end function lies_on

end module lithofrac_mesh_edge_set
