!> What must hold of a mesh and its topology, whatever cracks it has taken, in words.
module lithofrac_mesh_check
   use lithofrac_base_kinds, only: wp
   use lithofrac_base_status, only: bad_element, bad_input, ok, set_failure, status_type
   use lithofrac_mesh_mesh, only: mesh_type, triangle_area
   use lithofrac_mesh_rings, only: fan_of_node, fan_type
   use lithofrac_mesh_topology, only: corner_of, next_corner, topology_type
   implicit none
   private

   public :: check_topology

contains

   !> Say which invariant is broken first, and where.
   !>
   !> Living elements have a positive area; neighbours are mutual and see one edge from both
   !> sides; boundaries are simple loops; every node has elements, all in one fan, and sits in
   !> the lowest.
   subroutine check_topology(mesh, topology, status)
      type(mesh_type), intent(in) :: mesh
      type(topology_type), intent(in) :: topology
      type(status_type), intent(out) :: status

      integer :: element, k

      do element = 1, mesh%n_elements
         if (topology%alive(element)) call check_area(mesh, element, status)
         if (status%code /= ok) return
      end do
      do element = 1, mesh%n_elements
         if (.not. topology%alive(element)) cycle
         do k = 1, 3
            call check_link(mesh, topology, element, k, status)
            if (status%code /= ok) return
         end do
      end do
      call check_loops(mesh, topology, status)
      if (status%code == ok) call check_fans(mesh, topology, status)
   end subroutine check_topology

   subroutine check_area(mesh, element, status)
      type(mesh_type), intent(in) :: mesh
      integer, intent(in) :: element
      type(status_type), intent(out) :: status

      associate (corner => mesh%triangles(:, element))
         if (any(corner < 1) .or. any(corner > mesh%n_nodes)) then
            call complain(bad_input, "element # names a node that does not exist", [element], &
               status)
         else if (.not. triangle_area(mesh%nodes(:, corner(1)), mesh%nodes(:, corner(2)), &
               mesh%nodes(:, corner(3))) > 0.0_wp) then
            call complain(bad_element, "element # has no positive area", [element], status)
         end if
      end associate
   end subroutine check_area

   !> The neighbour lives, looks back, and shares both ends of the edge.
   subroutine check_link(mesh, topology, element, k, status)
      type(mesh_type), intent(in) :: mesh
      type(topology_type), intent(in) :: topology
      integer, intent(in) :: element
      integer, intent(in) :: k
      type(status_type), intent(out) :: status

      integer :: other, back

      other = topology%neighbour(k, element)
      if (other == 0) return
      if (other < 0 .or. other > mesh%n_elements) then
         call complain(bad_input, "element # has a neighbour # that does not exist", &
            [element, other], status)
         return
      end if
      if (.not. topology%alive(other)) then
         call complain(bad_input, "element # has a retired neighbour #", [element, other], status)
         return
      end if
      back = corner_of(mesh, other, mesh%triangles(next_corner(k), element))
      if (back == 0) then
         call complain(bad_input, "neighbours # and # share no edge", [element, other], status)
      else if (mesh%triangles(next_corner(back), other) /= mesh%triangles(k, element)) then
         call complain(bad_input, "neighbours # and # share no edge", [element, other], status)
      else if (topology%neighbour(back, other) /= element) then
         call complain(bad_input, "element # is a neighbour of # but not the other way round", &
            [other, element], status)
      end if
   end subroutine check_link

   !> All elements at a node lie in its one fan.
   subroutine check_fans(mesh, topology, status)
      type(mesh_type), intent(in) :: mesh
      type(topology_type), intent(in) :: topology
      type(status_type), intent(out) :: status

      integer, allocatable :: n_around(:), lowest(:)
      type(fan_type) :: fan
      integer :: element, node

      allocate (n_around(mesh%n_nodes), lowest(mesh%n_nodes), source=0)
      do element = mesh%n_elements, 1, -1
         if (.not. topology%alive(element)) cycle
         associate (corner => mesh%triangles(:, element))
            n_around(corner) = n_around(corner) + 1
            lowest(corner) = element
         end associate
      end do
      do node = 1, mesh%n_nodes
         if (n_around(node) == 0) then
            call complain(bad_input, "node # belongs to no element", [node], status)
         else if (topology%element_at(node) /= lowest(node)) then
            call complain(bad_input, "node # does not sit in its lowest element #", &
               [node, lowest(node)], status)
         else
            call fan_of_node(mesh, topology, node, fan)
            if (fan%n /= n_around(node)) call complain(bad_input, &
               "node # joins parts that share no edge", [node], status)
         end if
         if (status%code /= ok) return
      end do
   end subroutine check_fans

   !> Every boundary node is left once and reached once, so boundaries fall into simple loops.
   subroutine check_loops(mesh, topology, status)
      type(mesh_type), intent(in) :: mesh
      type(topology_type), intent(in) :: topology
      type(status_type), intent(out) :: status

      integer, allocatable :: left(:), reached(:)
      integer :: element, k, node

      allocate (left(mesh%n_nodes), reached(mesh%n_nodes), source=0)
      do element = 1, mesh%n_elements
         if (.not. topology%alive(element)) cycle
         do k = 1, 3
            if (topology%neighbour(k, element) > 0) cycle
            associate (a => mesh%triangles(k, element), &
                  b => mesh%triangles(next_corner(k), element))
               left(a) = left(a) + 1
               reached(b) = reached(b) + 1
            end associate
         end do
      end do
      do node = 1, mesh%n_nodes
         if (left(node) <= 1 .and. reached(node) == left(node)) cycle
         call complain(bad_input, "the boundary at node # is no simple loop", [node], status)
         return
      end do
   end subroutine check_loops

   !> Fail with words in which each # stands for one number.
   subroutine complain(code, words, numbers, status)
      integer, intent(in) :: code
      character(len=*), intent(in) :: words
      integer, intent(in) :: numbers(:)
      type(status_type), intent(out) :: status

      character(len=:), allocatable :: text
      character(len=12) :: digits
      integer :: i, at

      text = "mesh: "//words
      do i = 1, size(numbers)
         write (digits, "(i0)") numbers(i)
         at = index(text, "#")
         text = text(:at - 1)//trim(digits)//text(at + 1:)
      end do
      call set_failure(status, code, text)
   end subroutine complain

end module lithofrac_mesh_check
