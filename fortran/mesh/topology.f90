!> Who lies next to whom: three neighbours an element, one element a node.
!>
!> Edge k of an element runs from its corner k to the next one, counter-clockwise. Two elements
!> are neighbours where material is whole between them, which is less than to share two nodes:
!> an edge that has been cut on its own, with both ends still closed, is boundary on both sides.
!> Built once; `mesh/edits` changes it afterwards. It follows from a mesh and the cut edges
!> alone: whatever has a choice takes the lowest number.
module lithofrac_mesh_topology
   use lithofrac_base_status, only: bad_input, ok, set_failure, status_type
   use lithofrac_mesh_mesh, only: mesh_type
   implicit none
   private

   public :: topology_type, new_topology
   public :: corner_of, next_corner, previous_corner

   !> Capacity may exceed the counts, which are those of the mesh.
   type :: topology_type
      integer, allocatable :: neighbour(:, :)  !! (3, n_elements) across each edge, 0: none
      integer, allocatable :: element_at(:)    !! (n_nodes) lowest living element at a node
      integer, allocatable :: origin(:)        !! (n_elements) element of the first mesh it lies in
      logical, allocatable :: alive(:)         !! (n_elements) false once it has been cut
      integer :: changes = 0                   !! counts every change, also those taken back
   end type topology_type

   integer, parameter :: next_corner(3) = [2, 3, 1]
   integer, parameter :: previous_corner(3) = [3, 1, 2]

contains

   !> Find the neighbours of a mesh, or say which edge or node does not bound a body.
   subroutine new_topology(topology, mesh, status)
      type(topology_type), intent(out) :: topology
      type(mesh_type), intent(in) :: mesh
      type(status_type), intent(out) :: status

      integer, allocatable :: first(:), around(:)
      integer :: element

      allocate (topology%neighbour(3, mesh%n_elements), source=0)
      allocate (topology%element_at(mesh%n_nodes), source=0)
      allocate (topology%alive(mesh%n_elements), source=.true.)
      topology%origin = [(element, element=1, mesh%n_elements)]
      do element = mesh%n_elements, 1, -1
         topology%element_at(mesh%triangles(:, element)) = element
      end do
      call list_elements(mesh, first, around)
      call link_elements(topology, mesh, first, around, status)
      if (status%code == ok) call refuse_hinges(topology, mesh, status)
   end subroutine new_topology

   !> Which corner of an element a node is; 0 if it is none.
   pure function corner_of(mesh, element, node) result(corner)
      type(mesh_type), intent(in) :: mesh
      integer, intent(in) :: element
      integer, intent(in) :: node
      integer :: corner

      do corner = 3, 1, -1
         if (mesh%triangles(corner, element) == node) return
      end do
   end function corner_of

   !> Elements at each node: `around(first(node):first(node + 1) - 1)`, ascending.
   subroutine list_elements(mesh, first, around)
      type(mesh_type), intent(in) :: mesh
      integer, allocatable, intent(out) :: first(:)   !! (n_nodes + 1)
      integer, allocatable, intent(out) :: around(:)  !! (3*n_elements)

      integer :: element, k, node

      allocate (first(mesh%n_nodes + 1), source=0)
      allocate (around(3*mesh%n_elements))
      do element = 1, mesh%n_elements
         do k = 1, 3
            node = mesh%triangles(k, element)
            first(node) = first(node) + 1
         end do
      end do
      first(mesh%n_nodes + 1) = 3*mesh%n_elements + 1
      do node = mesh%n_nodes, 1, -1
         first(node) = first(node + 1) - first(node)
      end do
      do element = 1, mesh%n_elements
         do k = 1, 3
            node = mesh%triangles(k, element)
            around(first(node)) = element
            first(node) = first(node) + 1
         end do
      end do
      first(2:) = first(:mesh%n_nodes)
      first(1) = 1
   end subroutine list_elements

   subroutine link_elements(topology, mesh, first, around, status)
      type(topology_type), intent(inout) :: topology
      type(mesh_type), intent(in) :: mesh
      integer, intent(in) :: first(:)
      integer, intent(in) :: around(:)
      type(status_type), intent(out) :: status

      integer :: element, other, k, i, a, b, corner
      character(len=120) :: words

      do element = 1, mesh%n_elements
         do k = 1, 3
            a = mesh%triangles(k, element)
            b = mesh%triangles(next_corner(k), element)
            do i = first(a), first(a + 1) - 1
               other = around(i)
               if (other == element) cycle
               corner = corner_of(mesh, other, a)
               if (mesh%triangles(next_corner(corner), other) == b) then
                  write (words, "(a, i0, a, i0, a, i0, a, i0)") "mesh: elements ", element, &
                     " and ", other, " lie on the same side of edge ", a, " - ", b
                  call set_failure(status, bad_input, trim(words))
                  return
               end if
               if (mesh%triangles(previous_corner(corner), other) /= b) cycle
               topology%neighbour(k, element) = other
            end do
         end do
      end do
   end subroutine link_elements

   !> A node where two boundaries meet joins parts that share no edge.
   subroutine refuse_hinges(topology, mesh, status)
      type(topology_type), intent(in) :: topology
      type(mesh_type), intent(in) :: mesh
      type(status_type), intent(out) :: status

      integer, allocatable :: leaving(:)
      integer :: element, k
      character(len=80) :: words

      allocate (leaving(mesh%n_nodes), source=0)
      do element = 1, mesh%n_elements
         do k = 1, 3
            if (topology%neighbour(k, element) > 0) cycle
            associate (node => mesh%triangles(k, element))
               leaving(node) = leaving(node) + 1
            end associate
         end do
      end do
      if (all(leaving <= 1)) return
      write (words, "(a, i0, a)") "mesh: node ", maxloc(leaving, dim=1), &
         " joins parts that share no edge"
      call set_failure(status, bad_input, trim(words))
   end subroutine refuse_hinges

end module lithofrac_mesh_topology
