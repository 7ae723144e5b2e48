!> Open cracks. Nodes split as a consequence: a node has one copy a fan of whole elements.
!>
!> Where edges are cut, the links across them go; a node whose elements fall into two fans gives
!> a copy to one of them. Crack tips, branches, crossings, hits on a boundary and loose blocks
!> follow, and no two parts ever hang together by a single node. An inner edge that is cut on
!> its own opens nothing.
module lithofrac_mesh_split
   use lithofrac_base_kinds, only: wp
   use lithofrac_mesh_cut, only: cut_edge, guard_type, sound
   use lithofrac_mesh_edits, only: add_node, edits_type, remember, seat, start_edits, undo, unlink
   use lithofrac_mesh_mesh, only: mesh_type
   use lithofrac_mesh_rings, only: fan_type, walk_fan
   use lithofrac_mesh_topology, only: corner_of, next_corner, topology_type
   implicit none
   private

   public :: arm_type, open_arms, split_fans

   !> One way that a crack takes from its node.
   type :: arm_type
      integer :: element = 0
      integer :: edge = 0
      logical :: through = .false.   !! from the far corner to a new node on the edge, else along it
      real(wp) :: s = 0.0_wp         !! where on the edge, 0 at its start
   end type arm_type

contains

   !> Open the one or two arms of a crack, or change nothing at all.
   pure subroutine open_arms(mesh, topology, arms, guard, edits, verdict)
      type(mesh_type), intent(inout) :: mesh
      type(topology_type), intent(inout) :: topology
      type(arm_type), intent(in) :: arms(:)
      type(guard_type), intent(in) :: guard
      type(edits_type), intent(out) :: edits   !! of this crack alone
      integer, intent(out) :: verdict          !! `sound`, or why an arm may not be cut

      integer :: edge(2, size(arms)), i, node

      verdict = sound
      call start_edits(edits, mesh)
      do i = 1, size(arms)
         edge(:, i) = [arms(i)%element, arms(i)%edge]
         if (.not. arms(i)%through) cycle
         call cut_edge(mesh, topology, arms(i)%element, arms(i)%edge, arms(i)%s, guard, edits, &
            node, edge(:, i), verdict)
         if (verdict == sound) cycle
         call undo(mesh, topology, edits)
         return
      end do
      call split_fans(mesh, topology, edge, edits)
   end subroutine open_arms

   !> Cut edges and split the nodes at their ends. What is cut already stays as it is.
   pure subroutine split_fans(mesh, topology, edge, edits)
      type(mesh_type), intent(inout) :: mesh
      type(topology_type), intent(inout) :: topology
      integer, intent(in) :: edge(:, :)        !! (2, n) element and its edge, from either side
      type(edits_type), intent(inout) :: edits

      type(fan_type) :: fan, other_fan
      integer :: i, k, element, other, other_edge, ends(2)

      do i = 1, size(edge, 2)
         element = edge(1, i)
         other = topology%neighbour(edge(2, i), element)
         if (other == 0) cycle
         ends = mesh%triangles([edge(2, i), next_corner(edge(2, i))], element)
         other_edge = corner_of(mesh, other, ends(2))
         call unlink(mesh, topology, edge(:, i), [other, other_edge], edits)
         do k = 1, 2
            call split_node(mesh, topology, ends(k), element, other, fan, other_fan, edits)
         end do
      end do
   end subroutine split_fans

   !> Split a node if two of its elements no longer lie in one fan. The fan with the lowest
   !> element keeps the node.
   pure subroutine split_node(mesh, topology, node, element, other, fan, other_fan, edits)
      type(mesh_type), intent(inout) :: mesh
      type(topology_type), intent(inout) :: topology
      integer, intent(in) :: node
      integer, intent(in) :: element
      integer, intent(in) :: other
      type(fan_type), intent(inout) :: fan        !! working space
      type(fan_type), intent(inout) :: other_fan  !! working space
      type(edits_type), intent(inout) :: edits

      integer :: lowest, other_lowest

      call walk_fan(mesh, topology, node, element, fan)
      if (any(fan%element(:fan%n) == other)) return
      call walk_fan(mesh, topology, node, other, other_fan)
      lowest = minval(fan%element(:fan%n))
      other_lowest = minval(other_fan%element(:other_fan%n))
      if (lowest < other_lowest) then
         call move_fan(mesh, topology, node, other_fan, other_lowest, edits)
      else
         call move_fan(mesh, topology, node, fan, lowest, edits)
      end if
      call seat(topology, node, min(lowest, other_lowest), edits)
   end subroutine split_node

   !> Give a fan a copy of its node.
   pure subroutine move_fan(mesh, topology, node, fan, lowest, edits)
      type(mesh_type), intent(inout) :: mesh
      type(topology_type), intent(inout) :: topology
      integer, intent(in) :: node
      type(fan_type), intent(in) :: fan
      integer, intent(in) :: lowest             !! element of the fan
      type(edits_type), intent(inout) :: edits

      integer :: copy, i

      call add_node(mesh, topology, node, node, 0.0_wp, lowest, edits, copy)
      do i = 1, fan%n
         call remember(mesh, topology, fan%element(i), edits)
         mesh%triangles(fan%corner(i), fan%element(i)) = copy
      end do
   end subroutine move_fan

end module lithofrac_mesh_split
