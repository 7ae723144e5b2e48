!> Loads on a mesh that cracks: copies of a node move as it is told to, and pressure stays on
!> the edges that it acts on.
module lithofrac_mechanics_follow_loads
   use lithofrac_base_kinds, only: wp
   use lithofrac_mechanics_loads, only: measure_edges, pressure_type, velocity_type
   use lithofrac_mesh_edge_set, only: edge_nodes, follow_edges
   use lithofrac_mesh_edits, only: edits_type
   use lithofrac_mesh_mesh, only: mesh_type
   use lithofrac_mesh_topology, only: topology_type
   implicit none
   private

   public :: follow_pressure, follow_velocity

contains

   !> A new node is driven where both its parents are.
   pure subroutine follow_velocity(load, edits)
      type(velocity_type), intent(inout) :: load
      type(edits_type), intent(in) :: edits

      integer :: i, place(2)

      do i = 1, edits%n_nodes
         place(1) = findloc(load%node, edits%node_parent(1, i), dim=1)
         place(2) = findloc(load%node, edits%node_parent(2, i), dim=1)
         if (any(place == 0)) cycle
         load%node = [load%node, edits%nodes_before + i]
         load%before = [load%before, load%before(place(1)) &
            + edits%share(i)*(load%before(place(2)) - load%before(place(1)))]
      end do
   end subroutine follow_velocity

   !> Keep the edges and the forces on them; a piece of an edge takes its part of the thrust.
   subroutine follow_pressure(load, mesh, topology, edits)
      type(pressure_type), intent(inout) :: load
      type(mesh_type), intent(in) :: mesh
      type(topology_type), intent(in) :: topology
      type(edits_type), intent(in) :: edits

      integer, allocatable :: source(:)
      real(wp), allocatable :: force(:, :, :), length(:)
      integer :: i

      call follow_edges(mesh, topology, edits%element_parent(:edits%n_elements), &
         edits%elements_before + 1, load%held, source)
      load%edge = edge_nodes(mesh, load%held)
      call move_alloc(load%length, length)
      call measure_edges(load, mesh%nodes, .false.)
      if (edits%n_elements == 0) return
      allocate (force(2, 2, size(source)))
      do i = 1, size(source)
         force(:, :, i) = load%force(:, :, source(i))
         if (load%length(i) < length(source(i))) force(:, :, i) = spread(0.5_wp*load%length(i) &
            /length(source(i))*sum(load%force(:, :, source(i)), dim=2), 2, 2)
      end do
      call move_alloc(force, load%force)
   end subroutine follow_pressure

end module lithofrac_mechanics_follow_loads
