!> Damping of loose fragments: each against its own rigid motion, so that it flies and spins
!> freely and only its vibration dies down.
!>
!> Forces of a step come from the velocities of the half step before it and add up to no net
!> force and no moment in a fragment.
module lithofrac_fracture_fragment_drag
   use lithofrac_base_kinds, only: wp
   use lithofrac_mesh_mesh, only: mesh_type, triangle_area
   implicit none
   private

   public :: apply_drag, drag_power, fragment_drag_type, list_loose_nodes

   type :: fragment_drag_type
      integer, allocatable :: node(:)         !! (n) loose nodes, by fragment
      integer, allocatable :: first(:)        !! (n_fragments + 1) into `node`
      real(wp), allocatable :: force(:, :)    !! (2, n) at this step [N]
      real(wp) :: power_before = 0.0_wp       !! with the velocity before the half step [W]
   end type fragment_drag_type

contains

   !> Nodes of all parts but the largest of each body; who was loose keeps the force of now.
   pure subroutine list_loose_nodes(drag, mesh, part)
      type(fragment_drag_type), intent(inout) :: drag
      type(mesh_type), intent(in) :: mesh
      integer, intent(in) :: part(:)          !! (n_elements) as `find_parts`

      integer :: part_of(mesh%n_nodes), place(mesh%n_elements), node(mesh%n_nodes)
      integer :: element, i, n
      logical :: is_loose(mesh%n_elements)
      real(wp) :: force(2, mesh%n_nodes)

      force = 0.0_wp
      force(:, drag%node) = drag%force
      is_loose = find_loose(mesh, part)
      part_of = 0
      place = 0
      do element = 1, mesh%n_elements
         if (part(element) == 0) cycle
         if (.not. is_loose(part(element))) cycle
         part_of(mesh%triangles(:, element)) = part(element)
      end do
      do i = 1, mesh%n_nodes
         if (part_of(i) > 0) place(part_of(i)) = place(part_of(i)) + 1
      end do
      drag%first = [1, 1 + running_sum(pack(place, place > 0))]
      n = 1
      do element = 1, mesh%n_elements
         i = place(element)
         place(element) = n
         n = n + i
      end do
      do i = 1, mesh%n_nodes
         if (part_of(i) == 0) cycle
         node(place(part_of(i))) = i
         place(part_of(i)) = place(part_of(i)) + 1
      end do
      drag%node = node(:n - 1)
      drag%force = force(:, drag%node)
   end subroutine list_loose_nodes

   !> Parts that are not the largest of their body (of equals the first).
   pure function find_loose(mesh, part) result(is_loose)
      type(mesh_type), intent(in) :: mesh
      integer, intent(in) :: part(:)          !! (n_elements)
      logical :: is_loose(mesh%n_elements)    !! by number of the part

      real(wp) :: area(mesh%n_elements)       !! by number of the part [m2]
      integer :: element, body

      area = 0.0_wp
      do element = 1, mesh%n_elements
         if (part(element) == 0) cycle
         associate (corner => mesh%triangles(:, element), whole => area(part(element)))
            whole = whole + triangle_area(mesh%nodes(:, corner(1)), mesh%nodes(:, corner(2)), &
               mesh%nodes(:, corner(3)))
         end associate
      end do
      is_loose = area > 0.0_wp
      do body = 1, mesh%n_bodies
         is_loose(maxloc(area, dim=1, mask=mesh%body(:mesh%n_elements) == body)) = .false.
      end do
   end function find_loose

   pure function running_sum(values) result(sums)
      integer, intent(in) :: values(:)
      integer :: sums(size(values))

      integer :: i

      do i = 1, size(values)
         sums(i) = sum(values(:i))
      end do
   end function running_sum

   !> Forces of this step, added to those on the nodes; and their power.
   subroutine apply_drag(drag, alpha, body_of_node, nodes, u, v, mass, external)
      type(fragment_drag_type), intent(inout) :: drag
      real(wp), intent(in) :: alpha(:)            !! (n_bodies) [1/s]
      integer, intent(in) :: body_of_node(:)      !! (n_nodes)
      real(wp), intent(in) :: nodes(:, :)         !! (2, n_nodes) reference positions [m]
      real(wp), intent(in) :: u(:, :)             !! (2, n_nodes) [m]
      real(wp), intent(in) :: v(:, :)             !! (2, n_nodes) before the half step [m/s]
      real(wp), intent(in) :: mass(:)             !! (n_nodes) [kg]
      real(wp), intent(inout) :: external(:, :)   !! (2, n_nodes) [N]

      integer :: fragment

      do fragment = 1, size(drag%first) - 1
         call drag_fragment(drag%first(fragment), drag%first(fragment + 1) - 1)
      end do
      drag%power_before = drag_power(drag, v)

   contains

      subroutine drag_fragment(first, last)
         integer, intent(in) :: first
         integer, intent(in) :: last

         real(wp) :: total, centre(2), mean(2), spin, inertia, arm(2), slip(2), rate
         integer :: i

         total = 0.0_wp
         centre = 0.0_wp
         mean = 0.0_wp
         do i = first, last
            associate (m => mass(drag%node(i)))
               total = total + m
               centre = centre + m*(nodes(:, drag%node(i)) + u(:, drag%node(i)))
               mean = mean + m*v(:, drag%node(i))
            end associate
         end do
         centre = centre/total
         mean = mean/total
         spin = 0.0_wp
         inertia = 0.0_wp
         do i = first, last
            arm = nodes(:, drag%node(i)) + u(:, drag%node(i)) - centre
            slip = v(:, drag%node(i)) - mean
            spin = spin + mass(drag%node(i))*(arm(1)*slip(2) - arm(2)*slip(1))
            inertia = inertia + mass(drag%node(i))*dot_product(arm, arm)
         end do
         spin = spin/inertia
         ! one rate a fragment: bodies that share nodes may have two, and a sum that is not zero
         rate = alpha(body_of_node(drag%node(first)))
         do i = first, last
            arm = nodes(:, drag%node(i)) + u(:, drag%node(i)) - centre
            slip = v(:, drag%node(i)) - mean - spin*[-arm(2), arm(1)]
            drag%force(:, i) = -rate*mass(drag%node(i))*slip
            external(:, drag%node(i)) = external(:, drag%node(i)) + drag%force(:, i)
         end do
      end subroutine drag_fragment

   end subroutine apply_drag

   !> Power of the drag of this step [W], not positive with the velocity before.
   pure function drag_power(drag, v) result(power)
      type(fragment_drag_type), intent(in) :: drag
      real(wp), intent(in) :: v(:, :)             !! (2, n_nodes) [m/s]
      real(wp) :: power

      integer :: i

      power = 0.0_wp
      do i = 1, size(drag%node)
         power = power + dot_product(drag%force(:, i), v(:, drag%node(i)))
      end do
   end function drag_power

end module lithofrac_fracture_fragment_drag
