!> Cut two neighbouring elements by a new node on the edge between them (Klerck, Sellers & Owen
!> 2004, Fig. 4b): each falls into two, and the mesh stays conforming.
!>
!> A cut is judged before anything is written, so a refused one leaves no trace. Children lie
!> on the straight edges of a linear element: they keep its share s and 1 - s of the area in
!> every configuration, so positive areas need no check in the deformed one.
module lithofrac_mesh_cut
   use lithofrac_base_kinds, only: pi, wp
   use lithofrac_mesh_edits, only: add_element, add_node, edits_type, remember, retire, seat
   use lithofrac_mesh_mesh, only: mesh_type, triangle_area
   use lithofrac_mesh_rings, only: fan_type, walk_fan
   use lithofrac_mesh_shape, only: critical_length, mean_square_edge, smallest_angle
   use lithofrac_mesh_topology, only: corner_of, next_corner, previous_corner, topology_type
   implicit none
   private

   public :: guard_type, assess_cut, cut_edge, verdict_words
   public :: sound, near_end, small_step, small_area, small_angle

   integer, parameter :: sound = 0
   integer, parameter :: near_end = 1     !! snap to the end instead
   integer, parameter :: small_step = 2   !! a child would lower the time step too far
   integer, parameter :: small_area = 3
   integer, parameter :: small_angle = 4

   !> What a child must be. Step and size are held against the element of the first mesh, so
   !> that cutting again and again does not wear them away.
   type :: guard_type
      real(wp) :: snap = 0.25_wp                 !! least distance from an end, part of the edge
      real(wp) :: least_step = 0.4_wp            !! critical step, part of the parent's
      real(wp) :: least_area = 0.05_wp           !! area over the first element's mean squared edge
      real(wp) :: least_angle = pi/18.0_wp       !! [rad]
      real(wp), allocatable :: poisson(:)        !! (n_bodies) Poisson's ratios, for the step
   end type guard_type

contains

   !> May the edge be cut at parameter s? Looks at the children on both sides.
   pure function assess_cut(mesh, topology, element, edge, s, guard) result(verdict)
      type(mesh_type), intent(in) :: mesh
      type(topology_type), intent(in) :: topology
      integer, intent(in) :: element
      integer, intent(in) :: edge
      real(wp), intent(in) :: s              !! 0 at the start of the edge, 1 at its end
      type(guard_type), intent(in) :: guard
      integer :: verdict                     !! `sound`, or the first guard that is not held

      integer :: other, other_edge

      verdict = near_end
      if (.not. (s >= guard%snap .and. s <= 1.0_wp - guard%snap)) return
      verdict = assess_children(mesh, topology, element, edge, s, guard)
      if (verdict /= sound) return
      other = topology%neighbour(edge, element)
      if (other == 0) return
      other_edge = corner_of(mesh, other, mesh%triangles(next_corner(edge), element))
      verdict = assess_children(mesh, topology, other, other_edge, 1.0_wp - s, guard)
   end function assess_cut

   pure function assess_children(mesh, topology, element, edge, s, guard) result(verdict)
      type(mesh_type), intent(in) :: mesh
      type(topology_type), intent(in) :: topology
      integer, intent(in) :: element
      integer, intent(in) :: edge
      real(wp), intent(in) :: s
      type(guard_type), intent(in) :: guard
      integer :: verdict

      real(wp) :: first(2, 3), parent(2, 3), child(2, 3), middle(2), length, nu
      integer :: part

      first = mesh%nodes(:, mesh%triangles(:, topology%origin(element)))
      parent = mesh%nodes(:, mesh%triangles(:, element))
      nu = guard%poisson(mesh%body(element))
      length = guard%least_step*max(critical_length(first, nu), critical_length(parent, nu))
      middle = parent(:, edge) + s*(parent(:, next_corner(edge)) - parent(:, edge))
      verdict = sound
      do part = 1, 2
         child = parent
         if (part == 1) child(:, next_corner(edge)) = middle
         if (part == 2) child(:, edge) = middle
         if (.not. triangle_area(child(:, 1), child(:, 2), child(:, 3)) &
            >= guard%least_area*mean_square_edge(first)) then
            verdict = small_area
         else if (.not. critical_length(child, nu) >= length) then
            verdict = small_step
         else if (.not. smallest_angle(child) >= guard%least_angle) then
            verdict = small_angle
         end if
         if (verdict /= sound) return
      end do
   end function assess_children

   !> Put a node on an edge and cut the elements on both sides from their far corners to it.
   !>
   !> Nothing is opened: the children stay linked, and on a boundary edge there is one side.
   !> With a verdict other than `sound` nothing has changed.
   pure subroutine cut_edge(mesh, topology, element, edge, s, guard, edits, node, middle, verdict)
      type(mesh_type), intent(inout) :: mesh
      type(topology_type), intent(inout) :: topology
      integer, intent(in) :: element
      integer, intent(in) :: edge
      real(wp), intent(in) :: s
      type(guard_type), intent(in) :: guard
      type(edits_type), intent(inout) :: edits
      integer, intent(out) :: node            !! the new node, 0 if refused
      integer, intent(out) :: middle(2)       !! element and edge from the far corner to the node
      integer, intent(out) :: verdict

      integer :: other, other_edge, ends(2), child(2), other_child(2), apex, other_apex, i

      node = 0
      middle = 0
      verdict = assess_cut(mesh, topology, element, edge, s, guard)
      if (verdict /= sound) return
      ends = mesh%triangles([edge, next_corner(edge)], element)
      apex = mesh%triangles(previous_corner(edge), element)
      other = topology%neighbour(edge, element)
      call add_node(mesh, topology, ends(1), ends(2), s, element, edits, node)
      call halve(mesh, topology, element, edge, node, edits, child)
      call seat(topology, node, child(1), edits)
      if (other > 0) then
         other_edge = corner_of(mesh, other, ends(2))
         other_apex = mesh%triangles(previous_corner(other_edge), other)
         call halve(mesh, topology, other, other_edge, node, edits, other_child)
         topology%neighbour(2, child(1)) = other_child(2)
         topology%neighbour(2, other_child(2)) = child(1)
         topology%neighbour(2, child(2)) = other_child(1)
         topology%neighbour(2, other_child(1)) = child(2)
         call take_lowest(mesh, topology, other_apex, other_child(1), edits)
      end if
      call take_lowest(mesh, topology, apex, child(1), edits)
      do i = 1, 2
         call take_lowest(mesh, topology, ends(i), child(i), edits)
      end do
      middle = [child(2), 1]
   end subroutine cut_edge

   !> Replace an element by its two halves: (apex, start, node) and (apex, node, end).
   pure subroutine halve(mesh, topology, element, edge, node, edits, child)
      type(mesh_type), intent(inout) :: mesh
      type(topology_type), intent(inout) :: topology
      integer, intent(in) :: element
      integer, intent(in) :: edge
      integer, intent(in) :: node
      type(edits_type), intent(inout) :: edits
      integer, intent(out) :: child(2)

      integer :: apex, start, finish, outer(2), corner, i

      start = mesh%triangles(edge, element)
      finish = mesh%triangles(next_corner(edge), element)
      apex = mesh%triangles(previous_corner(edge), element)
      outer = topology%neighbour([previous_corner(edge), next_corner(edge)], element)
      call retire(mesh, topology, element, edits)
      call add_element(mesh, topology, [apex, start, node], element, edits, child(1))
      call add_element(mesh, topology, [apex, node, finish], element, edits, child(2))
      topology%neighbour(:, child(1)) = [outer(1), 0, child(2)]
      topology%neighbour(:, child(2)) = [child(1), 0, outer(2)]
      do i = 1, 2
         if (outer(i) == 0) cycle
         call remember(mesh, topology, outer(i), edits)
         corner = corner_of(mesh, outer(i), merge(start, apex, i == 1))
         topology%neighbour(corner, outer(i)) = child(i)
      end do
   end subroutine halve

   !> Seat a node in its lowest element again, if the one it had has been cut.
   pure subroutine take_lowest(mesh, topology, node, child, edits)
      type(mesh_type), intent(in) :: mesh
      type(topology_type), intent(inout) :: topology
      integer, intent(in) :: node
      integer, intent(in) :: child   !! an element at the node
      type(edits_type), intent(inout) :: edits

      type(fan_type) :: fan

      if (topology%alive(topology%element_at(node))) return
      call walk_fan(mesh, topology, node, child, fan)
      call seat(topology, node, minval(fan%element(:fan%n)), edits)
   end subroutine take_lowest

   !> A verdict for a person.
   pure function verdict_words(verdict) result(words)
      integer, intent(in) :: verdict
      character(len=:), allocatable :: words

      select case (verdict)
      case (sound)
         words = "sound"
      case (near_end)
         words = "too near the end of the edge"
      case (small_step)
         words = "a child would lower the time step too far"
      case (small_area)
         words = "a child would be too small"
      case (small_angle)
         words = "a child would be too pointed"
      case default
         words = "unknown"
      end select
   end function verdict_words

end module lithofrac_mesh_cut
