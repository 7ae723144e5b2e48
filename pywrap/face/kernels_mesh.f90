!> Meshes that crack, for tests: one slot holds a mesh, its topology and the last list of edits.
!> Only intrinsic types and explicit shapes here: this is a file that f2py reads. Every routine
!> ends with `code`, `message`; numbers start at 1. The file is long because all share the slots.
module kernels_mesh
   use, intrinsic :: iso_c_binding, only: c_double, c_int
   use lithofrac_base_status, only: bad_input, ok, set_failure, status_type
   use lithofrac_fracture_arms, only: choose_arms
   use lithofrac_fracture_failure_map, only: average_at_node, failure_factor, nodal_failure_type
   use lithofrac_fracture_plan, only: crack_type, plan_cracks, rules_type
   use lithofrac_mesh_check, only: check_topology
   use lithofrac_mesh_cut, only: cut_edge, guard_type, sound, verdict_words
   use lithofrac_mesh_edits, only: edits_type, inherit, start_edits, undo
   use lithofrac_mesh_mesh, only: mesh_type, new_mesh
   use lithofrac_mesh_rings, only: boundary_around, fan_of_node, fan_type
   use lithofrac_mesh_shape, only: critical_length, mean_square_edge, smallest_angle
   use lithofrac_mesh_split, only: arm_type, open_arms, split_fans
   use lithofrac_mesh_topology, only: new_topology, topology_type
   implicit none
   private

   public :: mesh_new, mesh_load, mesh_drop, mesh_sizes, mesh_arrays, mesh_edits
   public :: mesh_fan, mesh_boundary, mesh_check, mesh_follow, mesh_field
   public :: mesh_split, mesh_cut, mesh_open, mesh_undo, mesh_crack, mesh_average, mesh_plan
   public :: triangle_shapes, failure_factors

   integer, parameter :: max_slots = 64

   type :: slot_type
      logical :: used = .false.
      type(mesh_type) :: mesh
      type(topology_type) :: topology
      type(edits_type) :: edits
      real(c_double), allocatable :: field(:, :)   !! (2, n_nodes) follows the edits
   end type slot_type

   type(slot_type) :: slots(max_slots)

contains

   !> Build mesh and topology.
   subroutine mesh_new(nodes, n_nodes, triangles, body, n_elements, mesh, code, message)
      integer(c_int), intent(in) :: n_nodes, n_elements
      real(c_double), intent(in) :: nodes(2, n_nodes)          !! [m]
      integer(c_int), intent(in) :: triangles(3, n_elements)
      integer(c_int), intent(in) :: body(n_elements)
      integer(c_int), intent(out) :: mesh                      !! handle, 0 on failure
      integer(c_int), intent(out) :: code
      character(len=256), intent(out) :: message

      type(status_type) :: status

      call find_slot(mesh, status)
      if (status%code == ok) call new_mesh(slots(mesh)%mesh, nodes, triangles, body, status)
      if (status%code == ok) call new_topology(slots(mesh)%topology, slots(mesh)%mesh, status)
      call keep_slot(mesh, status, code, message)
   end subroutine mesh_new

   !> Take mesh and topology as they are given, good or not.
   subroutine mesh_load(nodes, n_nodes, triangles, neighbour, origin, alive, n_elements, &
         element_at, mesh, code, message)
      integer(c_int), intent(in) :: n_nodes, n_elements
      real(c_double), intent(in) :: nodes(2, n_nodes)          !! [m]
      integer(c_int), intent(in) :: triangles(3, n_elements)
      integer(c_int), intent(in) :: neighbour(3, n_elements)
      integer(c_int), intent(in) :: origin(n_elements)
      integer(c_int), intent(in) :: alive(n_elements)          !! 0 or 1
      integer(c_int), intent(in) :: element_at(n_nodes)
      integer(c_int), intent(out) :: mesh
      integer(c_int), intent(out) :: code
      character(len=256), intent(out) :: message

      type(status_type) :: status

      call find_slot(mesh, status)
      if (status%code == ok) then
         associate (m => slots(mesh)%mesh, topology => slots(mesh)%topology)
            m%n_nodes = n_nodes
            m%n_elements = n_elements
            m%nodes = nodes
            m%triangles = triangles
            m%n_bodies = 1
            allocate (m%body(n_elements), m%body_of_node(n_nodes), source=1)
            topology%neighbour = neighbour
            topology%origin = origin
            topology%alive = alive /= 0
            topology%element_at = element_at
         end associate
      end if
      call keep_slot(mesh, status, code, message)
   end subroutine mesh_load

   !> Forget a mesh.
   subroutine mesh_drop(mesh, code, message)
      integer(c_int), intent(in) :: mesh
      integer(c_int), intent(out) :: code
      character(len=256), intent(out) :: message

      call check_handle(mesh, code, message)
      if (code == ok) slots(mesh) = slot_type()
   end subroutine mesh_drop

   !> Nodes, elements, changes so far; of the last edits: new nodes, new elements, retired,
   !> changed, opened.
   subroutine mesh_sizes(mesh, sizes, code, message)
      integer(c_int), intent(in) :: mesh
      integer(c_int), intent(out) :: sizes(8)
      integer(c_int), intent(out) :: code
      character(len=256), intent(out) :: message

      sizes = 0
      call check_handle(mesh, code, message)
      if (code /= ok) return
      associate (slot => slots(mesh), edits => slots(mesh)%edits)
         sizes = [slot%mesh%n_nodes, slot%mesh%n_elements, slot%topology%changes, edits%n_nodes, &
            edits%n_elements, edits%n_retired, edits%n_changed, edits%n_opened]
      end associate
   end subroutine mesh_sizes

   subroutine mesh_arrays(mesh, n_nodes, n_elements, nodes, element_at, triangles, neighbour, &
         body, origin, alive, body_of_node, code, message)
      integer(c_int), intent(in) :: mesh, n_nodes, n_elements
      real(c_double), intent(out) :: nodes(2, n_nodes)
      integer(c_int), intent(out) :: element_at(n_nodes)
      integer(c_int), intent(out) :: triangles(3, n_elements)
      integer(c_int), intent(out) :: neighbour(3, n_elements)
      integer(c_int), intent(out) :: body(n_elements)
      integer(c_int), intent(out) :: origin(n_elements)
      integer(c_int), intent(out) :: alive(n_elements)
      integer(c_int), intent(out) :: body_of_node(n_nodes)
      integer(c_int), intent(out) :: code
      character(len=256), intent(out) :: message

      call check_handle(mesh, code, message)
      if (code /= ok) return
      associate (m => slots(mesh)%mesh, topology => slots(mesh)%topology)
         nodes = m%nodes(:, :n_nodes)
         element_at = topology%element_at(:n_nodes)
         triangles = m%triangles(:, :n_elements)
         neighbour = topology%neighbour(:, :n_elements)
         body = m%body(:n_elements)
         origin = topology%origin(:n_elements)
         alive = merge(1, 0, topology%alive(:n_elements))
         body_of_node = m%body_of_node(:n_nodes)
      end associate
   end subroutine mesh_arrays

   !> The last list of edits; sizes as `mesh_sizes` gives them.
   subroutine mesh_edits(mesh, n_nodes, n_elements, n_retired, n_changed, n_opened, node_parent, &
         share, element_parent, retired, changed, opened, code, message)
      integer(c_int), intent(in) :: mesh, n_nodes, n_elements, n_retired, n_changed, n_opened
      integer(c_int), intent(out) :: node_parent(2, n_nodes)
      real(c_double), intent(out) :: share(n_nodes)
      integer(c_int), intent(out) :: element_parent(n_elements)
      integer(c_int), intent(out) :: retired(n_retired)
      integer(c_int), intent(out) :: changed(n_changed)
      integer(c_int), intent(out) :: opened(4, n_opened)
      integer(c_int), intent(out) :: code
      character(len=256), intent(out) :: message

      call check_handle(mesh, code, message)
      if (code /= ok) return
      associate (edits => slots(mesh)%edits)
         if (n_nodes > 0) node_parent = edits%node_parent(:, :n_nodes)
         if (n_nodes > 0) share = edits%share(:n_nodes)
         if (n_elements > 0) element_parent = edits%element_parent(:n_elements)
         if (n_retired > 0) retired = edits%retired(:n_retired)
         if (n_changed > 0) changed = edits%changed(:n_changed)
         if (n_opened > 0) opened = edits%opened(:, :n_opened)
      end associate
   end subroutine mesh_edits

   !> Fan of a node; `n` may exceed the capacity, then the arrays hold its start.
   subroutine mesh_fan(mesh, node, capacity, n, closed, element, rim, code, message)
      integer(c_int), intent(in) :: mesh, node, capacity
      integer(c_int), intent(out) :: n
      integer(c_int), intent(out) :: closed             !! 0 or 1
      integer(c_int), intent(out) :: element(capacity)
      integer(c_int), intent(out) :: rim(capacity)      !! n + 1 nodes
      integer(c_int), intent(out) :: code
      character(len=256), intent(out) :: message

      type(fan_type) :: fan

      n = 0
      closed = 0
      element = 0
      rim = 0
      call check_node(mesh, node, code, message)
      if (code /= ok) return
      call fan_of_node(slots(mesh)%mesh, slots(mesh)%topology, node, fan)
      n = fan%n
      closed = merge(1, 0, fan%closed)
      element(:min(capacity, n)) = fan%element(:min(capacity, n))
      rim(:min(capacity, n + 1)) = fan%rim(:min(capacity, n + 1))
   end subroutine mesh_fan

   !> Boundary node before and after each node; 0 in the inside.
   subroutine mesh_boundary(mesh, n_nodes, before, after, code, message)
      integer(c_int), intent(in) :: mesh, n_nodes
      integer(c_int), intent(out) :: before(n_nodes)
      integer(c_int), intent(out) :: after(n_nodes)
      integer(c_int), intent(out) :: code
      character(len=256), intent(out) :: message

      integer :: node

      call check_handle(mesh, code, message)
      if (code /= ok) return
      do node = 1, n_nodes
         call boundary_around(slots(mesh)%mesh, slots(mesh)%topology, node, before(node), &
            after(node))
      end do
   end subroutine mesh_boundary

   !> Are the invariants held?
   subroutine mesh_check(mesh, code, message)
      integer(c_int), intent(in) :: mesh
      integer(c_int), intent(out) :: code
      character(len=256), intent(out) :: message

      type(status_type) :: status

      call check_handle(mesh, code, message)
      if (code /= ok) return
      call check_topology(slots(mesh)%mesh, slots(mesh)%topology, status)
      call export_status(status, code, message)
   end subroutine mesh_check

   !> Give the mesh a nodal field that follows all edits.
   subroutine mesh_follow(mesh, field, n_nodes, code, message)
      integer(c_int), intent(in) :: mesh, n_nodes
      real(c_double), intent(in) :: field(2, n_nodes)
      integer(c_int), intent(out) :: code
      character(len=256), intent(out) :: message

      call check_handle(mesh, code, message)
      if (code == ok) slots(mesh)%field = field
   end subroutine mesh_follow

   subroutine mesh_field(mesh, n_nodes, field, code, message)
      integer(c_int), intent(in) :: mesh, n_nodes
      real(c_double), intent(out) :: field(2, n_nodes)
      integer(c_int), intent(out) :: code
      character(len=256), intent(out) :: message

      call check_handle(mesh, code, message)
      if (code == ok) field = slots(mesh)%field(:, :n_nodes)
   end subroutine mesh_field

   !> Cut edges and split nodes.
   subroutine mesh_split(mesh, edge, n, code, message)
      integer(c_int), intent(in) :: mesh, n
      integer(c_int), intent(in) :: edge(2, n)   !! element and its edge, 1 to 3
      integer(c_int), intent(out) :: code
      character(len=256), intent(out) :: message

      integer :: i

      do i = 1, n
         call check_edge(mesh, edge(1, i), edge(2, i), code, message)
         if (code /= ok) return
      end do
      call check_handle(mesh, code, message)
      if (code /= ok) return
      associate (slot => slots(mesh))
         call start_edits(slot%edits, slot%mesh)
         call split_fans(slot%mesh, slot%topology, edge, slot%edits)
         if (allocated(slot%field)) call inherit(slot%edits, slot%field)
      end associate
   end subroutine mesh_split

   !> Put a node on an edge; `node` is 0 and `words` say why if a guard forbids it.
   subroutine mesh_cut(mesh, element, edge, s, guard, poisson, n_bodies, node, middle, verdict, &
         words, code, message)
      integer(c_int), intent(in) :: mesh, element, edge, n_bodies
      real(c_double), intent(in) :: s
      real(c_double), intent(in) :: guard(4)            !! snap, step, area, angle
      real(c_double), intent(in) :: poisson(n_bodies)
      integer(c_int), intent(out) :: node
      integer(c_int), intent(out) :: middle(2)          !! element and edge from the far corner
      integer(c_int), intent(out) :: verdict
      character(len=64), intent(out) :: words
      integer(c_int), intent(out) :: code
      character(len=256), intent(out) :: message

      node = 0
      middle = 0
      verdict = sound
      words = ""
      call check_edge(mesh, element, edge, code, message)
      if (code /= ok) return
      associate (slot => slots(mesh))
         call start_edits(slot%edits, slot%mesh)
         call cut_edge(slot%mesh, slot%topology, element, edge, s, guard_of(guard, poisson), &
            slot%edits, node, middle, verdict)
         if (allocated(slot%field)) call inherit(slot%edits, slot%field)
      end associate
      words = verdict_words(verdict)
   end subroutine mesh_cut

   !> Open the arms of one crack, or nothing.
   subroutine mesh_open(mesh, arms, n, guard, poisson, n_bodies, verdict, words, code, message)
      integer(c_int), intent(in) :: mesh, n, n_bodies
      real(c_double), intent(in) :: arms(3, n)          !! element, edge, s (below 0: along it)
      real(c_double), intent(in) :: guard(4)
      real(c_double), intent(in) :: poisson(n_bodies)
      integer(c_int), intent(out) :: verdict
      character(len=64), intent(out) :: words
      integer(c_int), intent(out) :: code
      character(len=256), intent(out) :: message

      type(arm_type) :: arm(n)
      integer :: i

      verdict = sound
      words = ""
      do i = 1, n
         arm(i) = arm_type(nint(arms(1, i)), nint(arms(2, i)), arms(3, i) >= 0.0_c_double, &
            arms(3, i))
         call check_edge(mesh, arm(i)%element, arm(i)%edge, code, message)
         if (code /= ok) return
      end do
      call check_handle(mesh, code, message)
      if (code /= ok) return
      associate (slot => slots(mesh))
         call open_arms(slot%mesh, slot%topology, arm, guard_of(guard, poisson), slot%edits, &
            verdict)
         if (allocated(slot%field)) call inherit(slot%edits, slot%field)
      end associate
      words = verdict_words(verdict)
   end subroutine mesh_open

   !> Take the last edits back.
   subroutine mesh_undo(mesh, code, message)
      integer(c_int), intent(in) :: mesh
      integer(c_int), intent(out) :: code
      character(len=256), intent(out) :: message

      call check_handle(mesh, code, message)
      if (code == ok) call undo(slots(mesh)%mesh, slots(mesh)%topology, slots(mesh)%edits)
   end subroutine mesh_undo

   !> Crack nodes in given directions, one after the other.
   subroutine mesh_crack(mesh, node, along, n, mode, guard, poisson, n_bodies, arms, crossings, &
         verdict, code, message)
      integer(c_int), intent(in) :: mesh, n, mode, n_bodies
      integer(c_int), intent(in) :: node(n)
      real(c_double), intent(in) :: along(2, n)         !! unit vectors
      real(c_double), intent(in) :: guard(4)
      real(c_double), intent(in) :: poisson(n_bodies)
      integer(c_int), intent(out) :: arms(n)            !! 0, 1 or 2
      integer(c_int), intent(out) :: crossings(n)       !! arms through an element
      integer(c_int), intent(out) :: verdict(n)         !! 0, or why nothing was done
      integer(c_int), intent(out) :: code
      character(len=256), intent(out) :: message

      type(arm_type), allocatable :: chosen(:)
      type(fan_type) :: fan
      integer :: i

      arms = 0
      crossings = 0
      verdict = 0
      do i = 1, n
         call check_node(mesh, node(i), code, message)
         if (code /= ok) return
         associate (slot => slots(mesh))
            call fan_of_node(slot%mesh, slot%topology, node(i), fan)
            call choose_arms(slot%mesh, slot%topology, fan, along(:, i), mode, &
               guard_of(guard, poisson), chosen)
            call open_arms(slot%mesh, slot%topology, chosen, guard_of(guard, poisson), &
               slot%edits, verdict(i))
            if (allocated(slot%field)) call inherit(slot%edits, slot%field)
         end associate
         arms(i) = size(chosen)
         crossings(i) = count(chosen%through)
      end do
      call check_handle(mesh, code, message)
   end subroutine mesh_crack

   !> Failure map of all nodes.
   subroutine mesh_average(mesh, factor, normal, n_elements, weights, n_nodes, mean, along, &
         agreement, code, message)
      integer(c_int), intent(in) :: mesh, n_elements, weights, n_nodes
      real(c_double), intent(in) :: factor(n_elements)
      real(c_double), intent(in) :: normal(2, n_elements)
      real(c_double), intent(out) :: mean(n_nodes)
      real(c_double), intent(out) :: along(2, n_nodes)
      real(c_double), intent(out) :: agreement(n_nodes)
      integer(c_int), intent(out) :: code
      character(len=256), intent(out) :: message

      type(fan_type) :: fan
      type(nodal_failure_type) :: failure
      integer :: node

      call check_sizes(mesh, n_nodes, n_elements, code, message)
      if (code /= ok) return
      do node = 1, n_nodes
         call average_at_node(slots(mesh)%mesh, slots(mesh)%topology, node, factor, normal, &
            weights, fan, failure)
         mean(node) = failure%factor
         along(:, node) = failure%along
         agreement(node) = failure%agreement
      end do
   end subroutine mesh_average

   !> Planned cracks, at most `most`; an arm is element, edge, s (-1: along the edge), 0s if none.
   subroutine mesh_plan(mesh, factor, normal, n_elements, mode, weights, most, guard, poisson, &
         n_bodies, n, node, mean, arms, n_waiting, n_closed, code, message)
      integer(c_int), intent(in) :: mesh, n_elements, mode, weights, most, n_bodies
      real(c_double), intent(in) :: factor(n_elements)
      real(c_double), intent(in) :: normal(2, n_elements)
      real(c_double), intent(in) :: guard(4)
      real(c_double), intent(in) :: poisson(n_bodies)
      integer(c_int), intent(out) :: n
      integer(c_int), intent(out) :: node(most)
      real(c_double), intent(out) :: mean(most)
      real(c_double), intent(out) :: arms(3, 2, most)
      integer(c_int), intent(out) :: n_waiting
      integer(c_int), intent(out) :: n_closed
      integer(c_int), intent(out) :: code
      character(len=256), intent(out) :: message

      real(c_double), allocatable :: retry(:)
      type(crack_type), allocatable :: cracks(:)
      integer :: i, k

      n = 0
      node = 0
      mean = 0.0_c_double
      arms = 0.0_c_double
      n_waiting = 0
      n_closed = 0
      call check_handle(mesh, code, message)
      if (code == ok) call check_sizes(mesh, slots(mesh)%mesh%n_nodes, n_elements, code, message)
      if (code /= ok) return
      allocate (retry(slots(mesh)%mesh%n_nodes), source=0.0_c_double)
      call plan_cracks(slots(mesh)%mesh, slots(mesh)%topology, factor, normal, &
         rules_type(mode, weights, most, guard_of(guard, poisson)), retry, cracks, n_waiting, &
         n_closed)
      n = size(cracks)
      do i = 1, n
         node(i) = cracks(i)%node
         mean(i) = cracks(i)%failure%factor
         do k = 1, size(cracks(i)%arms)
            associate (arm => cracks(i)%arms(k))
               arms(:, k, i) = [real(arm%element, c_double), real(arm%edge, c_double), &
                  merge(arm%s, -1.0_c_double, arm%through)]
            end associate
         end do
      end do
   end subroutine mesh_plan

   !> Critical step times P wave speed, smallest angle and mean squared edge of triangles.
   subroutine triangle_shapes(corners, poisson, n, length, angle, square, code, message)
      integer(c_int), intent(in) :: n
      real(c_double), intent(in) :: corners(2, 3, n)   !! [m]
      real(c_double), intent(in) :: poisson(n)
      real(c_double), intent(out) :: length(n)         !! [m]
      real(c_double), intent(out) :: angle(n)          !! [rad]
      real(c_double), intent(out) :: square(n)         !! [m2]
      integer(c_int), intent(out) :: code
      character(len=256), intent(out) :: message

      integer :: i

      code = ok
      message = ""
      do i = 1, n
         length(i) = critical_length(corners(:, :, i), poisson(i))
         angle(i) = smallest_angle(corners(:, :, i))
         square(i) = mean_square_edge(corners(:, :, i))
      end do
   end subroutine triangle_shapes

   !> F_k of tension planes (eq. 21).
   subroutine failure_factors(opening, softening, ft, n, factor, code, message)
      integer(c_int), intent(in) :: n
      real(c_double), intent(in) :: opening(n)
      real(c_double), intent(in) :: softening(n)   !! [Pa]
      real(c_double), intent(in) :: ft(n)          !! [Pa]
      real(c_double), intent(out) :: factor(n)
      integer(c_int), intent(out) :: code
      character(len=256), intent(out) :: message

      code = ok
      message = ""
      factor = failure_factor(opening, softening, ft)
   end subroutine failure_factors

   subroutine find_slot(mesh, status)
      integer(c_int), intent(out) :: mesh
      type(status_type), intent(out) :: status

      do mesh = 1, max_slots
         if (.not. slots(mesh)%used) return
      end do
      call set_failure(status, bad_input, "too many meshes are open")
   end subroutine find_slot

   subroutine keep_slot(mesh, status, code, message)
      integer(c_int), intent(inout) :: mesh
      type(status_type), intent(in) :: status
      integer(c_int), intent(out) :: code
      character(len=256), intent(out) :: message

      call export_status(status, code, message)
      if (code == ok) then
         slots(mesh)%used = .true.
         call start_edits(slots(mesh)%edits, slots(mesh)%mesh)
      else
         if (mesh <= max_slots) slots(mesh) = slot_type()
         mesh = 0
      end if
   end subroutine keep_slot

   pure function guard_of(numbers, poisson) result(guard)
      real(c_double), intent(in) :: numbers(4)
      real(c_double), intent(in) :: poisson(:)
      type(guard_type) :: guard

      guard = guard_type(numbers(1), numbers(2), numbers(3), numbers(4), poisson)
   end function guard_of

   subroutine check_handle(mesh, code, message)
      integer(c_int), intent(in) :: mesh
      integer(c_int), intent(out) :: code
      character(len=256), intent(out) :: message

      type(status_type) :: status

      if (mesh < 1 .or. mesh > max_slots) then
         call set_failure(status, bad_input, "no such mesh")
      else if (.not. slots(mesh)%used) then
         call set_failure(status, bad_input, "no such mesh")
      end if
      call export_status(status, code, message)
   end subroutine check_handle

   subroutine check_node(mesh, node, code, message)
      integer(c_int), intent(in) :: mesh, node
      integer(c_int), intent(out) :: code
      character(len=256), intent(out) :: message

      type(status_type) :: status

      call check_handle(mesh, code, message)
      if (code /= ok) return
      if (node < 1 .or. node > slots(mesh)%mesh%n_nodes) then
         call set_failure(status, bad_input, "no such node")
      end if
      call export_status(status, code, message)
   end subroutine check_node

   subroutine check_edge(mesh, element, edge, code, message)
      integer(c_int), intent(in) :: mesh, element, edge
      integer(c_int), intent(out) :: code
      character(len=256), intent(out) :: message

      type(status_type) :: status

      call check_handle(mesh, code, message)
      if (code /= ok) return
      if (element < 1 .or. element > slots(mesh)%mesh%n_elements) then
         call set_failure(status, bad_input, "no such element")
      else if (.not. slots(mesh)%topology%alive(element)) then
         call set_failure(status, bad_input, "the element has been cut")
      else if (edge < 1 .or. edge > 3) then
         call set_failure(status, bad_input, "edges are numbered 1 to 3")
      end if
      call export_status(status, code, message)
   end subroutine check_edge

   subroutine check_sizes(mesh, n_nodes, n_elements, code, message)
      integer(c_int), intent(in) :: mesh, n_nodes, n_elements
      integer(c_int), intent(out) :: code
      character(len=256), intent(out) :: message

      type(status_type) :: status

      call check_handle(mesh, code, message)
      if (code /= ok) return
      if (n_nodes /= slots(mesh)%mesh%n_nodes .or. n_elements /= slots(mesh)%mesh%n_elements) then
         call set_failure(status, bad_input, "arrays do not fit the mesh")
      end if
      call export_status(status, code, message)
   end subroutine check_sizes

   subroutine export_status(status, code, message)
      type(status_type), intent(in) :: status
      integer(c_int), intent(out) :: code
      character(len=256), intent(out) :: message

      code = status%code
      message = ""
      if (allocated(status%message)) message = status%message
   end subroutine export_status

end module kernels_mesh
