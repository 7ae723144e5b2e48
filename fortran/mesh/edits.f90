!> The changes of a mesh as a list: the only module that writes to a mesh once it is built.
!>
!> Read forwards, the list tells every owner of nodal or element arrays what was born of what;
!> read backwards, it takes the changes back. Numbers are never used again: a new node or
!> element stands behind all others, and an element that was cut keeps its place.
module lithofrac_mesh_edits
   use lithofrac_base_growth, only: append, reserve
   use lithofrac_base_kinds, only: wp
   use lithofrac_mesh_mesh, only: mesh_type
   use lithofrac_mesh_topology, only: topology_type
   implicit none
   private

   public :: edits_type, inherit, merge_edits, start_edits, undo
   public :: add_element, add_node, remember, retire, seat, unlink

   !> Births, retirements and changes, in order. Arrays may be longer than their counts.
   type :: edits_type
      integer :: nodes_before = 0                    !! new node i is number nodes_before + i
      integer :: elements_before = 0                 !! likewise
      integer :: n_nodes = 0                         !! nodes born
      integer :: n_elements = 0                      !! elements born
      integer :: n_retired = 0
      integer :: n_changed = 0
      integer :: n_opened = 0
      integer, allocatable :: node_parent(:, :)      !! (2, n_nodes) ends of its edge, or twice one
      real(wp), allocatable :: share(:)              !! (n_nodes) weight of the second parent [-]
      integer, allocatable :: element_parent(:)      !! (n_elements) element each one is cut from
      integer, allocatable :: retired(:)             !! (n_retired) elements that are no more
      integer, allocatable :: changed(:)             !! (n_changed) in corners or neighbours
      integer, allocatable :: opened(:, :)           !! (4, n_opened) element, edge; element, edge
      integer, allocatable, private :: before(:, :)  !! (6, n_changed) corners and neighbours
      integer, private :: n_seats = 0
      integer, allocatable, private :: seats(:, :)   !! (2, n_seats) node, its element before
   end type edits_type

contains

   !> An empty list for the mesh as it is.
   pure subroutine start_edits(edits, mesh)
      type(edits_type), intent(out) :: edits
      type(mesh_type), intent(in) :: mesh

      edits%nodes_before = mesh%n_nodes
      edits%elements_before = mesh%n_elements
      allocate (edits%node_parent(2, 0), edits%share(0), edits%element_parent(0))
   end subroutine start_edits

   !> A new node at x = (1 - share) x(first) + share x(second); a copy has share 0.
   pure subroutine add_node(mesh, topology, first, second, share, element, edits, node)
      type(mesh_type), intent(inout) :: mesh
      type(topology_type), intent(inout) :: topology
      integer, intent(in) :: first
      integer, intent(in) :: second
      real(wp), intent(in) :: share
      integer, intent(in) :: element             !! at the node; gives its body
      type(edits_type), intent(inout) :: edits
      integer, intent(out) :: node

      call append(edits%node_parent, edits%n_nodes, [first, second])
      call reserve(edits%share, edits%n_nodes)
      edits%share(edits%n_nodes) = share
      node = mesh%n_nodes + 1
      call reserve(mesh%nodes, node)
      call reserve(mesh%body_of_node, node)
      call reserve(topology%element_at, node)
      mesh%n_nodes = node
      mesh%nodes(:, node) = between(mesh%nodes(:, first), mesh%nodes(:, second), share)
      mesh%body_of_node(node) = mesh%body(element)
      topology%element_at(node) = element
      topology%changes = topology%changes + 1
   end subroutine add_node

   !> A new element without neighbours, cut from `parent`.
   pure subroutine add_element(mesh, topology, corners, parent, edits, element)
      type(mesh_type), intent(inout) :: mesh
      type(topology_type), intent(inout) :: topology
      integer, intent(in) :: corners(3)
      integer, intent(in) :: parent
      type(edits_type), intent(inout) :: edits
      integer, intent(out) :: element

      call append(edits%element_parent, edits%n_elements, parent)
      element = mesh%n_elements + 1
      call reserve(mesh%triangles, element)
      call reserve(mesh%body, element)
      call reserve(topology%neighbour, element)
      call reserve(topology%origin, element)
      call reserve(topology%alive, element)
      mesh%n_elements = element
      mesh%triangles(:, element) = corners
      mesh%body(element) = mesh%body(parent)
      topology%neighbour(:, element) = 0
      topology%origin(element) = topology%origin(parent)
      topology%alive(element) = .true.
      topology%changes = topology%changes + 1
   end subroutine add_element

   !> Note corners and neighbours of an element that is about to change.
   pure subroutine remember(mesh, topology, element, edits)
      type(mesh_type), intent(in) :: mesh
      type(topology_type), intent(inout) :: topology
      integer, intent(in) :: element
      type(edits_type), intent(inout) :: edits

      integer :: n

      n = edits%n_changed
      call append(edits%before, n, [mesh%triangles(:, element), topology%neighbour(:, element)])
      call append(edits%changed, edits%n_changed, element)
      topology%changes = topology%changes + 1
   end subroutine remember

   !> Take an element out of the mesh; its corners stay on record, its neighbours do not.
   pure subroutine retire(mesh, topology, element, edits)
      type(mesh_type), intent(in) :: mesh
      type(topology_type), intent(inout) :: topology
      integer, intent(in) :: element
      type(edits_type), intent(inout) :: edits

      call remember(mesh, topology, element, edits)
      call append(edits%retired, edits%n_retired, element)
      topology%neighbour(:, element) = 0
      topology%alive(element) = .false.
   end subroutine retire

   !> Let `element` stand for `node`.
   pure subroutine seat(topology, node, element, edits)
      type(topology_type), intent(inout) :: topology
      integer, intent(in) :: node
      integer, intent(in) :: element
      type(edits_type), intent(inout) :: edits

      if (topology%element_at(node) == element) return
      call append(edits%seats, edits%n_seats, [node, topology%element_at(node)])
      topology%element_at(node) = element
      topology%changes = topology%changes + 1
   end subroutine seat

   !> Cut the link across two matching edges.
   pure subroutine unlink(mesh, topology, edge, other_edge, edits)
      type(mesh_type), intent(in) :: mesh
      type(topology_type), intent(inout) :: topology
      integer, intent(in) :: edge(2)        !! element and its edge
      integer, intent(in) :: other_edge(2)  !! the same edge seen from the other element
      type(edits_type), intent(inout) :: edits

      call remember(mesh, topology, edge(1), edits)
      call remember(mesh, topology, other_edge(1), edits)
      call append(edits%opened, edits%n_opened, [edge, other_edge])
      topology%neighbour(edge(2), edge(1)) = 0
      topology%neighbour(other_edge(2), other_edge(1)) = 0
   end subroutine unlink

   !> Take everything back, to the bit; the list is empty afterwards.
   pure subroutine undo(mesh, topology, edits)
      type(mesh_type), intent(inout) :: mesh
      type(topology_type), intent(inout) :: topology
      type(edits_type), intent(inout) :: edits

      integer :: i

      do i = edits%n_changed, 1, -1
         mesh%triangles(:, edits%changed(i)) = edits%before(:3, i)
         topology%neighbour(:, edits%changed(i)) = edits%before(4:, i)
      end do
      do i = 1, edits%n_retired
         topology%alive(edits%retired(i)) = .true.
      end do
      do i = edits%n_seats, 1, -1
         topology%element_at(edits%seats(1, i)) = edits%seats(2, i)
      end do
      associate (nodes => edits%nodes_before, elements => edits%elements_before)
         mesh%nodes(:, nodes + 1:mesh%n_nodes) = 0.0_wp
         mesh%body_of_node(nodes + 1:mesh%n_nodes) = 0
         topology%element_at(nodes + 1:mesh%n_nodes) = 0
         mesh%triangles(:, elements + 1:mesh%n_elements) = 0
         mesh%body(elements + 1:mesh%n_elements) = 0
         topology%neighbour(:, elements + 1:mesh%n_elements) = 0
         topology%origin(elements + 1:mesh%n_elements) = 0
         topology%alive(elements + 1:mesh%n_elements) = .false.
         mesh%n_nodes = nodes
         mesh%n_elements = elements
      end associate
      topology%changes = topology%changes + 1
      call start_edits(edits, mesh)
   end subroutine undo

   !> Add later edits behind earlier ones, for owners that follow several at a time; what comes
   !> out cannot be undone.
   pure subroutine merge_edits(edits, later)
      type(edits_type), intent(inout) :: edits
      type(edits_type), intent(in) :: later

      integer :: i

      do i = 1, later%n_nodes
         call append(edits%node_parent, edits%n_nodes, later%node_parent(:, i))
         call reserve(edits%share, edits%n_nodes)
         edits%share(edits%n_nodes) = later%share(i)
      end do
      do i = 1, later%n_elements
         call append(edits%element_parent, edits%n_elements, later%element_parent(i))
      end do
      do i = 1, later%n_retired
         call append(edits%retired, edits%n_retired, later%retired(i))
      end do
      do i = 1, later%n_changed
         call append(edits%changed, edits%n_changed, later%changed(i))
      end do
      do i = 1, later%n_opened
         call append(edits%opened, edits%n_opened, later%opened(:, i))
      end do
   end subroutine merge_edits

   !> Give the new nodes their values of a nodal field: a copy, or a mean between two parents.
   !>
   !> With velocities this keeps the momentum: what a node on an edge takes over from the
   !> masses of its ends, A/3 in the shares 1 - s and s, moves at the same mean.
   pure subroutine inherit(edits, values)
      type(edits_type), intent(in) :: edits
      real(wp), allocatable, intent(inout) :: values(:, :)  !! (k, >= nodes_before), grows

      integer :: i

      call reserve(values, edits%nodes_before + edits%n_nodes)
      do i = 1, edits%n_nodes
         values(:, edits%nodes_before + i) = between(values(:, edits%node_parent(1, i)), &
            values(:, edits%node_parent(2, i)), edits%share(i))
      end do
   end subroutine inherit

   !> Value between two values, the first one exactly for share 0.
   pure elemental function between(first, second, share) result(value)
      real(wp), intent(in) :: first
      real(wp), intent(in) :: second
      real(wp), intent(in) :: share  !! weight of the second [-]
      real(wp) :: value

      value = first + share*(second - first)
   end function between

end module lithofrac_mesh_edits
