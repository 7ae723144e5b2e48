!> Parts that overlap from the start cannot be kept apart: find them and say where.
module lithofrac_contact_overlap
   use lithofrac_base_kinds, only: wp
   use lithofrac_base_status, only: bad_input, set_failure, status_type
   use lithofrac_contact_clashes, only: clashes_type, distances_behind, find_clashes
   use lithofrac_contact_surfaces, only: list_edges
   use lithofrac_mesh_mesh, only: mesh_type
   implicit none
   private

   public :: refuse_overlap

   real(wp), parameter :: allowed = 1.0e-3_wp     !! depth that contact takes back, over h
   real(wp), parameter :: touching = 1.0e-6_wp    !! depth that is rounding, over h

   !> Boundary edges, part by part.
   type :: boundary_type
      integer, allocatable :: edge(:, :)          !! (2, n) nodes
      integer, allocatable :: first(:)            !! (n_parts + 1) into `edge`
      real(wp) :: h = 0.0_wp                      !! shortest one in the reference [m]
   end type boundary_type

contains

   !> Fail if connected parts share some of the plane: told is the node that is deepest inside
   !> another part, or, where parts cross without such a node, the deepest pair of elements.
   !>
   !> A part that folds over itself is not looked for.
   subroutine refuse_overlap(mesh, u, origin, subject, status)
      type(mesh_type), intent(in) :: mesh
      real(wp), intent(in) :: u(:, :)            !! (2, >= n_nodes) displacement [m]
      real(wp), intent(in) :: origin(2)          !! that positions are relative to [m]
      character(len=*), intent(in) :: subject    !! of the sentence
      type(status_type), intent(out) :: status

      type(boundary_type) :: boundary
      type(clashes_type) :: clashes
      integer, allocatable :: part(:)
      real(wp) :: x(2, mesh%n_nodes), depth
      integer :: n_parts, node, k
      character(len=200) :: words

      call find_parts(mesh, part, n_parts)
      if (n_parts == 1) return
      x = mesh%nodes(:, :mesh%n_nodes) + u(:, :mesh%n_nodes)
      call find_boundary(mesh, part, n_parts, boundary)
      call find_clashes(clashes, corners_of(mesh, x), part(mesh%triangles(1, :mesh%n_elements)), &
         touching*boundary%h)
      if (clashes%n == 0) return
      call find_deepest(mesh, x, boundary, clashes, depth, node)
      k = maxloc(clashes%depth(:clashes%n), dim=1)
      if (depth > allowed*boundary%h) then
         write (words, "(2a, i0, a, 2es11.3, a, es9.2, 2a)") subject, ": node ", node, " at", &
            x(:, node) + origin, " m stands", depth, " m inside another part; ", &
            "parts must not overlap at the start"
      else if (clashes%depth(k) > allowed*boundary%h) then
         associate (pair => clashes%pair(:, k))
            write (words, "(2a, 2(i0, a), 2es11.3, a, es9.2, 2a)") subject, ": elements ", &
               minval(pair), " and ", maxval(pair), " of two parts cross at", &
               meeting_place(clashes, pair) + origin, " m,", clashes%depth(k), " m deep; ", &
               "parts must not overlap at the start"
         end associate
      else
         return
      end if
      call set_failure(status, bad_input, trim(words))
   end subroutine refuse_overlap

   !> Number, from 1, of the connected part of every node.
   subroutine find_parts(mesh, part, n_parts)
      type(mesh_type), intent(in) :: mesh
      integer, allocatable, intent(out) :: part(:)
      integer, intent(out) :: n_parts

      integer :: element, k, a, b, root(mesh%n_nodes)

      root = [(a, a=1, mesh%n_nodes)]
      do element = 1, mesh%n_elements
         do k = 2, 3
            a = root_of(root, mesh%triangles(1, element))
            b = root_of(root, mesh%triangles(k, element))
            root(max(a, b)) = min(a, b)
         end do
      end do
      allocate (part(mesh%n_nodes))
      n_parts = 0
      do a = 1, mesh%n_nodes
         root(a) = root(root(a))
         if (root(a) == a) then
            n_parts = n_parts + 1
            part(a) = n_parts
         else
            part(a) = part(root(a))
         end if
      end do
   end subroutine find_parts

   !> Representative of a set; shortens the way to it.
   function root_of(parent, node) result(root)
      integer, intent(inout) :: parent(:)
      integer, intent(in) :: node
      integer :: root

      root = node
      do while (parent(root) /= root)
         parent(root) = parent(parent(root))
         root = parent(root)
      end do
   end function root_of

   !> Edges with an element on one side only, in order of parts; a node may join several.
   subroutine find_boundary(mesh, part, n_parts, boundary)
      type(mesh_type), intent(in) :: mesh
      integer, intent(in) :: part(:)             !! (n_nodes)
      integer, intent(in) :: n_parts
      type(boundary_type), intent(out) :: boundary

      integer :: first(mesh%n_nodes + 1), end_of(3*mesh%n_elements), place(n_parts + 1)
      integer :: a, b, k, pass
      real(wp) :: shortest

      call list_edges(mesh, first, end_of)
      allocate (boundary%first(n_parts + 1), source=0)
      shortest = huge(1.0_wp)
      do pass = 1, 2
         do a = 1, mesh%n_nodes
            do k = first(a), first(a + 1) - 1
               b = end_of(k)
               if (any(end_of(first(b):first(b + 1) - 1) == a)) cycle
               if (pass == 1) then
                  boundary%first(part(a) + 1) = boundary%first(part(a) + 1) + 1
                  shortest = min(shortest, norm2(mesh%nodes(:, b) - mesh%nodes(:, a)))
               else
                  boundary%edge(:, place(part(a))) = [a, b]
                  place(part(a)) = place(part(a)) + 1
               end if
            end do
         end do
         if (pass == 2) exit
         boundary%first(1) = 1
         do k = 1, n_parts
            boundary%first(k + 1) = boundary%first(k + 1) + boundary%first(k)
         end do
         place = boundary%first
         allocate (boundary%edge(2, boundary%first(n_parts + 1) - 1))
      end do
      boundary%h = shortest
   end subroutine find_boundary

   !> Corners of all elements, (2, 3, n_elements) [m].
   pure function corners_of(mesh, x) result(corner)
      type(mesh_type), intent(in) :: mesh
      real(wp), intent(in) :: x(:, :)            !! (2, n_nodes) positions [m]
      real(wp) :: corner(2, 3, mesh%n_elements)

      integer :: element

      do element = 1, mesh%n_elements
         corner(:, :, element) = x(:, mesh%triangles(:, element))
      end do
   end function corners_of

   !> The node that is deepest inside a part to which it does not belong; depth 0 without one.
   pure subroutine find_deepest(mesh, x, boundary, clashes, depth, node)
      type(mesh_type), intent(in) :: mesh
      real(wp), intent(in) :: x(:, :)            !! (2, n_nodes) positions [m]
      type(boundary_type), intent(in) :: boundary
      type(clashes_type), intent(in) :: clashes
      real(wp), intent(out) :: depth             !! distance from the boundary of that part [m]
      integer, intent(out) :: node

      integer :: looked_at(mesh%n_nodes)         ! part that a node was last held against
      integer :: i, k, side, other
      real(wp) :: here

      looked_at = 0
      depth = 0.0_wp
      node = 0
      do i = 1, clashes%n
         do side = 1, 2
            associate (mine => mesh%triangles(:, clashes%pair(side, i)), &
                  triangle => clashes%corner(:, :, clashes%pair(3 - side, i)))
               other = clashes%part(clashes%pair(3 - side, i))
               do k = 1, 3
                  if (looked_at(mine(k)) == other) cycle
                  if (any(distances_behind(triangle, x(:, mine(k))) < -clashes%least)) cycle
                  looked_at(mine(k)) = other
                  here = distance_from(x, boundary, other, x(:, mine(k)))
                  if (here <= depth) cycle
                  depth = here
                  node = mine(k)
               end do
            end associate
         end do
      end do
   end subroutine find_deepest

   !> Distance of a point from the boundary of a part [m].
   pure function distance_from(x, boundary, part, point) result(distance)
      real(wp), intent(in) :: x(:, :)            !! (2, n_nodes) positions [m]
      type(boundary_type), intent(in) :: boundary
      integer, intent(in) :: part
      real(wp), intent(in) :: point(2)           !! [m]
      real(wp) :: distance

      real(wp) :: arm(2), along(2), share
      integer :: k

      distance = huge(1.0_wp)
      do k = boundary%first(part), boundary%first(part + 1) - 1
         along = x(:, boundary%edge(2, k)) - x(:, boundary%edge(1, k))
         arm = point - x(:, boundary%edge(1, k))
         share = max(0.0_wp, min(1.0_wp, dot_product(arm, along)/dot_product(along, along)))
         distance = min(distance, norm2(arm - share*along))
      end do
   end function distance_from

   !> Middle of what the boxes of two elements share [m].
   pure function meeting_place(clashes, pair) result(x)
      type(clashes_type), intent(in) :: clashes
      integer, intent(in) :: pair(2)
      real(wp) :: x(2)

      x = 0.5_wp*(maxval(clashes%low(:, pair), dim=2) + minval(clashes%high(:, pair), dim=2))
   end function meeting_place

end module lithofrac_contact_overlap
