!> Fans and boundary loops, found by walking from neighbour to neighbour.
module lithofrac_mesh_rings
   use lithofrac_base_growth, only: reserve
   use lithofrac_mesh_mesh, only: mesh_type
   use lithofrac_mesh_topology, only: corner_of, next_corner, previous_corner, topology_type
   implicit none
   private

   public :: fan_type, boundary_around, fan_of_node, on_boundary, spoke, walk_fan

   !> Elements around a node, counter-clockwise. Spokes are the edges at the node: element i
   !> lies between spokes i and i + 1. An open fan starts and ends on the boundary; a closed one
   !> starts at its lowest element, and its last spoke is the first again.
   type :: fan_type
      integer :: n = 0                    !! elements
      logical :: closed = .false.
      integer, allocatable :: element(:)  !! (n)
      integer, allocatable :: corner(:)   !! (n) which corner of each element the node is
      integer, allocatable :: rim(:)      !! (n + 1) node at the far end of each spoke
   end type fan_type

contains

   !> Fan of a node.
   pure subroutine fan_of_node(mesh, topology, node, fan)
      type(mesh_type), intent(in) :: mesh
      type(topology_type), intent(in) :: topology
      integer, intent(in) :: node
      type(fan_type), intent(inout) :: fan  !! its memory is used again

      call walk_fan(mesh, topology, node, topology%element_at(node), fan)
   end subroutine fan_of_node

   !> Elements that can be reached around `node` from one of its elements.
   pure subroutine walk_fan(mesh, topology, node, start, fan)
      type(mesh_type), intent(in) :: mesh
      type(topology_type), intent(in) :: topology
      integer, intent(in) :: node
      integer, intent(in) :: start          !! an element at `node`
      type(fan_type), intent(inout) :: fan  !! its memory is used again

      integer :: element, first, corner

      call find_first(mesh, topology, node, start, first, fan%closed)
      fan%n = 0
      element = first
      do
         corner = corner_of(mesh, element, node)
         call reserve(fan%element, fan%n + 1)
         call reserve(fan%corner, fan%n + 1)
         call reserve(fan%rim, fan%n + 2)
         fan%n = fan%n + 1
         fan%element(fan%n) = element
         fan%corner(fan%n) = corner
         fan%rim(fan%n) = mesh%triangles(next_corner(corner), element)
         fan%rim(fan%n + 1) = mesh%triangles(previous_corner(corner), element)
         element = topology%neighbour(previous_corner(corner), element)
         if (element == first .or. element == 0) exit
      end do
   end subroutine walk_fan

   !> Clockwise end of a fan: the element on the boundary, or the lowest of a closed fan.
   pure subroutine find_first(mesh, topology, node, start, first, closed)
      type(mesh_type), intent(in) :: mesh
      type(topology_type), intent(in) :: topology
      integer, intent(in) :: node
      integer, intent(in) :: start
      integer, intent(out) :: first
      logical, intent(out) :: closed

      integer :: element, before

      first = start
      element = start
      do
         before = topology%neighbour(corner_of(mesh, element, node), element)
         closed = before == start
         if (closed) return
         if (before == 0) exit
         element = before
         first = min(first, element)
      end do
      first = element
   end subroutine find_first

   !> A spoke of a fan as (element, edge); the last one of an open fan is seen from inside.
   pure function spoke(fan, i) result(edge)
      type(fan_type), intent(in) :: fan
      integer, intent(in) :: i          !! 1 to n, or n + 1
      integer :: edge(2)

      if (i <= fan%n) then
         edge = [fan%element(i), fan%corner(i)]
      else
         edge = [fan%element(fan%n), previous_corner(fan%corner(fan%n))]
      end if
   end function spoke

   !> Nodes before and after `node` on its boundary, material on the left; 0 in the inside.
   pure subroutine boundary_around(mesh, topology, node, before, after)
      type(mesh_type), intent(in) :: mesh
      type(topology_type), intent(in) :: topology
      integer, intent(in) :: node
      integer, intent(out) :: before
      integer, intent(out) :: after

      integer :: element, next
      logical :: closed

      before = 0
      after = 0
      call find_first(mesh, topology, node, topology%element_at(node), element, closed)
      if (closed) return
      after = mesh%triangles(next_corner(corner_of(mesh, element, node)), element)
      do
         next = topology%neighbour(previous_corner(corner_of(mesh, element, node)), element)
         if (next == 0) exit
         element = next
      end do
      before = mesh%triangles(previous_corner(corner_of(mesh, element, node)), element)
   end subroutine boundary_around

   !> Does a boundary, a crack face or a closed cut end at this node?
   pure function on_boundary(mesh, topology, node) result(yes)
      type(mesh_type), intent(in) :: mesh
      type(topology_type), intent(in) :: topology
      integer, intent(in) :: node
      logical :: yes

      integer :: element
      logical :: closed

      call find_first(mesh, topology, node, topology%element_at(node), element, closed)
      yes = .not. closed
   end function on_boundary

end module lithofrac_mesh_rings
