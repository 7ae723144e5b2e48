!> Triangles and nodes, checked once; everything else builds on a good mesh.
!>
!> This module knows nothing of materials, forces or time.
module lithofrac_mesh_mesh
   use lithofrac_base_kinds, only: wp
   use lithofrac_base_status, only: bad_element, bad_input, ok, set_failure, status_type
   implicit none
   private

   public :: living_part, mesh_type, new_mesh, triangle_area

   !> Three-node triangles, counter-clockwise.
   type :: mesh_type
      integer :: n_nodes = 0
      integer :: n_elements = 0
      real(wp), allocatable :: nodes(:, :)       !! (2, n_nodes) reference positions [m]
      integer, allocatable :: triangles(:, :)    !! (3, n_elements) node numbers
      integer, allocatable :: body(:)            !! (n_elements) body number, from 1
      integer, allocatable :: body_of_node(:)    !! (n_nodes) body of the first element at a node
      integer :: n_bodies = 0
   end type mesh_type

contains

   !> Build a mesh, or say in words which node or element is wrong.
   subroutine new_mesh(mesh, nodes, triangles, body, status)
      type(mesh_type), intent(out) :: mesh
      real(wp), intent(in) :: nodes(:, :)        !! (2, n_nodes) [m]
      integer, intent(in) :: triangles(:, :)     !! (3, n_elements) from 1, counter-clockwise
      integer, intent(in) :: body(:)             !! (n_elements) from 1
      type(status_type), intent(out) :: status

      mesh%n_nodes = size(nodes, 2)
      mesh%n_elements = size(triangles, 2)
      mesh%nodes = nodes
      mesh%triangles = triangles
      mesh%body = body
      mesh%n_bodies = maxval(body)
      call check_numbers(mesh, status)
      if (status%code /= ok) return
      call check_areas(mesh, status)
      if (status%code /= ok) return
      call assign_bodies(mesh, status)
   end subroutine new_mesh

   !> The same nodes and those elements that have not been cut, in arrays without spare room.
   pure function living_part(mesh, alive) result(part)
      type(mesh_type), intent(in) :: mesh
      logical, intent(in) :: alive(:)            !! (>= n_elements)
      type(mesh_type) :: part

      integer :: i, element(count(alive(:mesh%n_elements)))

      element = pack([(i, i=1, mesh%n_elements)], alive(:mesh%n_elements))
      part%n_nodes = mesh%n_nodes
      part%n_elements = size(element)
      part%nodes = mesh%nodes(:, :mesh%n_nodes)
      part%triangles = mesh%triangles(:, element)
      part%body = mesh%body(element)
      part%body_of_node = mesh%body_of_node(:mesh%n_nodes)
      part%n_bodies = mesh%n_bodies
   end function living_part

   !> Signed area of a triangle [m2], positive when counter-clockwise.
   pure function triangle_area(a, b, c) result(area)
      real(wp), intent(in) :: a(2)
      real(wp), intent(in) :: b(2)
      real(wp), intent(in) :: c(2)
      real(wp) :: area

      area = 0.5_wp*((b(1) - a(1))*(c(2) - a(2)) - (b(2) - a(2))*(c(1) - a(1)))
   end function triangle_area

   subroutine check_numbers(mesh, status)
      type(mesh_type), intent(in) :: mesh
      type(status_type), intent(out) :: status

      if (mesh%n_nodes < 3 .or. mesh%n_elements < 1) then
         call set_failure(status, bad_input, "mesh: needs at least one triangle of three nodes")
      else if (any(mesh%triangles < 1) .or. any(mesh%triangles > mesh%n_nodes)) then
         call set_failure(status, bad_input, "mesh: a triangle names a node that does not exist")
      else if (any(mesh%body < 1)) then
         call set_failure(status, bad_input, "mesh: bodies are numbered from 1")
      else if (.not. all(abs(mesh%nodes) <= huge(1.0_wp))) then
         call set_failure(status, bad_input, "mesh: a node position is not finite")
      end if
   end subroutine check_numbers

   subroutine check_areas(mesh, status)
      type(mesh_type), intent(in) :: mesh
      type(status_type), intent(out) :: status

      character(len=80) :: words
      integer :: element

      do element = 1, mesh%n_elements
         associate (corner => mesh%triangles(:, element))
            if (triangle_area(mesh%nodes(:, corner(1)), mesh%nodes(:, corner(2)), &
                  mesh%nodes(:, corner(3))) > 0.0_wp) cycle
         end associate
         write (words, "(a, i0, a)") "mesh: element ", element, " has no positive area"
         call set_failure(status, bad_element, trim(words))
         return
      end do
   end subroutine check_areas

   subroutine assign_bodies(mesh, status)
      type(mesh_type), intent(inout) :: mesh
      type(status_type), intent(out) :: status

      character(len=80) :: words
      integer :: element

      allocate (mesh%body_of_node(mesh%n_nodes), source=0)
      do element = mesh%n_elements, 1, -1
         mesh%body_of_node(mesh%triangles(:, element)) = mesh%body(element)
      end do
      if (all(mesh%body_of_node > 0)) return
      write (words, "(a, i0, a)") "mesh: node ", findloc(mesh%body_of_node, 0, dim=1), &
         " belongs to no element"
      call set_failure(status, bad_input, trim(words))
   end subroutine assign_bodies

end module lithofrac_mesh_mesh
