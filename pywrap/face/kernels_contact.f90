!> Contact kernels on their own, for tests: one pair, one corner, the boundary of a mesh.
module kernels_contact
   use, intrinsic :: iso_c_binding, only: c_double, c_int
   use lithofrac_base_status, only: ok, status_type
   use lithofrac_contact_corners, only: classify
   use lithofrac_contact_friction, only: one_face, two_faces
   use lithofrac_contact_islands, only: find_islands, group_islands
   use lithofrac_contact_search, only: candidates_type, list_candidates
   use lithofrac_contact_surfaces, only: new_surfaces, surfaces_type, update_shape
   use lithofrac_mesh_mesh, only: mesh_type, new_mesh
   implicit none
   private

   public :: boundary_of, candidates_of, corner_kind, islands_of, pair_impulse

contains

   !> Impulse of a pair with one or two faces.
   subroutine pair_impulse(d0, normals, bias, n_faces, friction, compliance, impulse, code, &
         message)
      integer(c_int), intent(in) :: n_faces
      real(c_double), intent(in) :: d0(2)                  !! [m/s]
      real(c_double), intent(in) :: normals(2, n_faces)
      real(c_double), intent(in) :: bias(n_faces)          !! [m/s]
      real(c_double), intent(in) :: friction
      real(c_double), intent(in) :: compliance(2)          !! [1/kg]
      real(c_double), intent(out) :: impulse(2)            !! [N s]
      integer(c_int), intent(out) :: code
      character(len=256), intent(out) :: message

      code = ok
      message = ""
      if (n_faces == 1) then
         impulse = one_face(d0, normals(:, 1), bias(1), friction, compliance)
      else
         impulse = two_faces(d0, normals(:, :2), bias(:2), friction, compliance)
      end if
   end subroutine pair_impulse

   !> Kind and limiting faces of a corner, numbered as in `lithofrac_contact_corners`.
   subroutine corner_kind(tangents, kind, face, neighbours, code, message)
      real(c_double), intent(in) :: tangents(2, 4)   !! into and out of the first, the second node
      integer(c_int), intent(out) :: kind
      integer(c_int), intent(out) :: face(2)
      integer(c_int), intent(out) :: neighbours      !! 1: nothing fits between them
      integer(c_int), intent(out) :: code
      character(len=256), intent(out) :: message

      logical :: side_by_side

      code = ok
      message = ""
      call classify(tangents(:, 1), tangents(:, 2), tangents(:, 3), tangents(:, 4), kind, face, &
         side_by_side)
      neighbours = merge(1, 0, side_by_side)
   end subroutine corner_kind

   !> The boundary node after each node, and the shortest edge; 0 off the boundary.
   subroutine boundary_of(nodes, n_nodes, triangles, n_elements, next, shortest, code, message)
      integer(c_int), intent(in) :: n_nodes, n_elements
      real(c_double), intent(in) :: nodes(2, n_nodes)          !! [m]
      integer(c_int), intent(in) :: triangles(3, n_elements)
      integer(c_int), intent(out) :: next(n_nodes)
      real(c_double), intent(out) :: shortest                  !! [m]
      integer(c_int), intent(out) :: code
      character(len=256), intent(out) :: message

      type(surfaces_type) :: surfaces
      type(status_type) :: status

      next = 0
      shortest = 0.0_c_double
      call make_surfaces(nodes, triangles, surfaces, status)
      code = status%code
      message = ""
      if (allocated(status%message)) message = status%message
      if (code /= ok) return
      next(surfaces%node) = surfaces%node(surfaces%next)
      shortest = surfaces%h
   end subroutine boundary_of

   !> Candidates of displaced nodes: the first `counts` columns are corners, then node-edge pairs.
   subroutine candidates_of(nodes, u, n_nodes, triangles, n_elements, n_room, counts, pairs, &
         code, message)
      integer(c_int), intent(in) :: n_nodes, n_elements, n_room
      real(c_double), intent(in) :: nodes(2, n_nodes)          !! [m]
      real(c_double), intent(in) :: u(2, n_nodes)              !! [m]
      integer(c_int), intent(in) :: triangles(3, n_elements)
      integer(c_int), intent(out) :: counts(2)                 !! corners, node-edge pairs
      integer(c_int), intent(out) :: pairs(2, n_room)          !! node; node or start of edge
      integer(c_int), intent(out) :: code
      character(len=256), intent(out) :: message

      type(surfaces_type) :: surfaces
      type(candidates_type) :: list
      type(status_type) :: status
      integer :: i, n

      counts = 0
      pairs = 0
      call make_surfaces(nodes, triangles, surfaces, status)
      code = status%code
      message = ""
      if (allocated(status%message)) message = status%message
      if (code /= ok) return
      surfaces%u = u(:, surfaces%node)
      call update_shape(surfaces)
      call list_candidates(list, surfaces)
      counts = [size(list%corner, 2), size(list%edge, 2)]
      do i = 1, min(n_room, sum(counts))
         n = i - counts(1)
         if (n <= 0) pairs(:, i) = surfaces%node(list%corner(:, i))
         if (n > 0) pairs(:, i) = surfaces%node(list%edge(:, n))
      end do
   end subroutine candidates_of

   !> Island and group of every node, by the candidates of a mesh; 0 off the boundary.
   subroutine islands_of(nodes, n_nodes, triangles, n_elements, n_groups, island, group, code, &
         message)
      integer(c_int), intent(in) :: n_nodes, n_elements, n_groups
      real(c_double), intent(in) :: nodes(2, n_nodes)          !! [m]
      integer(c_int), intent(in) :: triangles(3, n_elements)
      integer(c_int), intent(out) :: island(n_nodes)           !! lowest node of the island
      integer(c_int), intent(out) :: group(n_nodes)
      integer(c_int), intent(out) :: code
      character(len=256), intent(out) :: message

      type(surfaces_type) :: surfaces
      type(candidates_type) :: list
      type(status_type) :: status
      integer, allocatable :: found(:), weight(:), grouped(:)

      island = 0
      group = 0
      call make_surfaces(nodes, triangles, surfaces, status)
      code = status%code
      message = ""
      if (allocated(status%message)) message = status%message
      if (code /= ok) return
      call list_candidates(list, surfaces)
      allocate (found(surfaces%n), weight(surfaces%n), grouped(surfaces%n))
      call find_islands(surfaces, list, found)
      weight = 1
      call group_islands(found, weight, n_groups, grouped)
      island(surfaces%node) = surfaces%node(found)
      group(surfaces%node) = grouped
   end subroutine islands_of

   subroutine make_surfaces(nodes, triangles, surfaces, status)
      real(c_double), intent(in) :: nodes(:, :)
      integer(c_int), intent(in) :: triangles(:, :)
      type(surfaces_type), intent(out) :: surfaces
      type(status_type), intent(out) :: status

      type(mesh_type) :: mesh
      integer :: i

      call new_mesh(mesh, nodes, triangles, [(1, i=1, size(triangles, 2))], status)
      if (status%code == ok) call new_surfaces(surfaces, mesh, status)
   end subroutine make_surfaces

end module kernels_contact
