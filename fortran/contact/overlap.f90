!> Parts that overlap from the start cannot be kept apart: find them and say where.
module lithofrac_contact_overlap
   use lithofrac_base_kinds, only: wp
   use lithofrac_base_status, only: bad_input, set_failure, status_type
   use lithofrac_contact_surfaces, only: offset, surfaces_type
   use lithofrac_mesh_mesh, only: mesh_type
   implicit none
   private

   public :: refuse_overlap

   real(wp), parameter :: allowed = 1.0e-3_wp  !! depth that contact takes back, over h

contains

   !> Fail if a boundary node of one connected part stands inside another.
   !>
   !> A part that folds over itself is not looked for.
   subroutine refuse_overlap(surfaces, mesh, origin, status)
      type(surfaces_type), intent(in) :: surfaces
      type(mesh_type), intent(in) :: mesh
      real(wp), intent(in) :: origin(2)   !! that positions are relative to [m]
      type(status_type), intent(out) :: status

      integer, allocatable :: part(:), order(:), first(:)
      integer :: i, p
      real(wp) :: low(2), high(2), x(2), depth
      character(len=160) :: words

      part = parts_of(mesh)
      part = part(surfaces%node)
      call group(part, order, first)
      associate (at => surfaces%reference + surfaces%u)
         do p = 1, size(first) - 1
            associate (members => order(first(p):first(p + 1) - 1))
               low = minval(at(:, members), dim=2)
               high = maxval(at(:, members), dim=2)
               do i = 1, surfaces%n
                  x = at(:, i)
                  if (any(x <= low .or. x >= high) .or. part(i) == part(members(1))) cycle
                  depth = depth_inside(surfaces, members, i)
                  if (depth <= allowed*surfaces%h) cycle
                  write (words, "(a, i0, a, 2es11.3, a, es9.2, a)") "contact: node ", &
                     surfaces%node(i), " at", x + origin, " m stands", depth, &
                     " m inside another part; parts must not overlap at the start"
                  call set_failure(status, bad_input, trim(words))
                  return
               end do
            end associate
         end do
      end associate
   end subroutine refuse_overlap

   !> Connected part of every node: the smallest number of a node that it hangs together with.
   function parts_of(mesh) result(part)
      type(mesh_type), intent(in) :: mesh
      integer, allocatable :: part(:)

      integer :: element, k, a, b

      part = [(a, a=1, mesh%n_nodes)]
      do element = 1, mesh%n_elements
         do k = 2, 3
            a = root_of(part, mesh%triangles(1, element))
            b = root_of(part, mesh%triangles(k, element))
            part(max(a, b)) = min(a, b)
         end do
      end do
      do a = 1, mesh%n_nodes
         part(a) = part(part(a))
      end do
   end function parts_of

   !> Representative of a set; shortens the way to it.
   function root_of(part, node) result(root)
      integer, intent(inout) :: part(:)
      integer, intent(in) :: node
      integer :: root

      root = node
      do while (part(root) /= root)
         part(root) = part(part(root))
         root = part(root)
      end do
   end function root_of

   !> Boundary nodes in order of parts, and where each part starts.
   subroutine group(part, order, first)
      integer, intent(in) :: part(:)
      integer, allocatable, intent(out) :: order(:)
      integer, allocatable, intent(out) :: first(:)

      integer :: count_of(0:maxval(part)), i, p, n

      count_of = 0
      do i = 1, size(part)
         count_of(part(i)) = count_of(part(i)) + 1
      end do
      n = count(count_of > 0)
      allocate (order(size(part)), first(n + 1))
      n = 0
      first(1) = 1
      do p = 1, maxval(part)
         if (count_of(p) == 0) cycle
         n = n + 1
         first(n + 1) = first(n) + count_of(p)
         count_of(p) = first(n)
      end do
      do i = 1, size(part)
         order(count_of(part(i))) = i
         count_of(part(i)) = count_of(part(i)) + 1
      end do
   end subroutine group

   !> Distance to the boundary of a part, 0 for a node outside it [m].
   pure function depth_inside(surfaces, edges, i) result(depth)
      type(surfaces_type), intent(in) :: surfaces
      integer, intent(in) :: edges(:)     !! boundary edges of the part
      integer, intent(in) :: i            !! boundary node of another part
      real(wp) :: depth

      real(wp) :: a(2), b(2), nearest
      logical :: inside
      integer :: k

      inside = .false.
      nearest = huge(1.0_wp)
      do k = 1, size(edges)
         a = offset(surfaces, edges(k), i)
         b = offset(surfaces, surfaces%next(edges(k)), i)
         nearest = min(nearest, distance(a, b))
         if ((a(2) > 0.0_wp) .neqv. (b(2) > 0.0_wp)) then
            if (a(1) - a(2)*(b(1) - a(1))/(b(2) - a(2)) > 0.0_wp) inside = .not. inside
         end if
      end do
      depth = merge(nearest, 0.0_wp, inside)
   end function depth_inside

   !> Distance of the origin from the edge a-b [m].
   pure function distance(a, b)
      real(wp), intent(in) :: a(2)
      real(wp), intent(in) :: b(2)
      real(wp) :: distance

      real(wp) :: share

      share = max(0.0_wp, min(1.0_wp, -dot_product(a, b - a)/dot_product(b - a, b - a)))
      distance = norm2(a + share*(b - a))
   end function distance

end module lithofrac_contact_overlap
