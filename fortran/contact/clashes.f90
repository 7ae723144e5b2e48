!> Pairs of triangles of different parts that share some of the plane.
!>
!> Two triangles are apart if all of one lies behind an edge of the other; if no edge parts them,
!> the shortest shift that does so is along the normal of one of their six edges, since the
!> difference of two convex polygons has no other sides. A shift by the length d changes that
!> depth by d at most, so parts that touch have pairs of depth zero, but for rounding.
!>
!> This module knows nothing of nodes, boundaries or forces.
module lithofrac_contact_clashes
   use lithofrac_base_growth, only: append
   use lithofrac_base_kinds, only: wp
   implicit none
   private

   public :: clashes_type, distances_behind, find_clashes

   integer, parameter :: few = 16   !! elements that are tried each with each

   !> What is searched, and what has been found.
   type :: clashes_type
      integer :: n = 0
      integer, allocatable :: pair(:, :)     !! (2, >= n) elements; a pair may stand twice
      real(wp), allocatable :: depth(:)      !! (>= n) shortest shift that parts them [m]
      real(wp), allocatable :: corner(:, :, :)  !! (2, 3, n_elements) counter-clockwise [m]
      real(wp), allocatable :: low(:, :)     !! (2, n_elements) lower corner of the box [m]
      real(wp), allocatable :: high(:, :)    !! (2, n_elements) upper one [m]
      integer, allocatable :: part(:)        !! (n_elements)
      real(wp) :: least = 0.0_wp             !! pairs that are not deeper do not count [m]
   end type clashes_type

contains

   !> Find all pairs of elements of different parts that are deeper in each other than `least`.
   subroutine find_clashes(clashes, corner, part, least)
      type(clashes_type), intent(out) :: clashes
      real(wp), intent(in) :: corner(:, :, :)   !! (2, 3, n_elements) counter-clockwise [m]
      integer, intent(in) :: part(:)            !! (n_elements)
      real(wp), intent(in) :: least             !! [m]

      integer :: i

      clashes%corner = corner
      clashes%low = minval(corner, dim=2)
      clashes%high = maxval(corner, dim=2)
      clashes%part = part
      clashes%least = least
      call search(clashes, [(i, i=1, size(part))])
   end subroutine find_clashes

   !> Search some elements: all of one part hold no pair; many are halved at the mean of their
   !> boxes, across the longer way if that parts them, and an element on the cut goes to both
   !> halves. So cost follows the length of what meets, whatever the sizes of elements.
   recursive subroutine search(clashes, element)
      type(clashes_type), intent(inout) :: clashes
      integer, intent(in) :: element(:)

      integer, allocatable :: lower(:), upper(:)
      real(wp) :: middle(2), extent(2)
      integer :: axis, attempt

      if (size(element) < 2) return
      if (all(clashes%part(element) == clashes%part(element(1)))) return
      if (size(element) > few) then
         associate (low => clashes%low(:, element), high => clashes%high(:, element))
            middle = 0.5_wp*sum(low + high, dim=2)/size(element)
            extent = maxval(high, dim=2) - minval(low, dim=2)
         end associate
         do attempt = 1, 2
            axis = merge(1, 2, (extent(1) >= extent(2)) .eqv. attempt == 1)
            lower = pack(element, clashes%low(axis, element) <= middle(axis))
            upper = pack(element, clashes%high(axis, element) >= middle(axis))
            if (2*(size(lower) + size(upper)) > 3*size(element)) cycle
            if (max(size(lower), size(upper)) == size(element)) cycle
            call search(clashes, lower)
            call search(clashes, upper)
            return
         end do
      end if
      call try_all(clashes, element)
   end subroutine search

   !> Try each with each.
   subroutine try_all(clashes, element)
      type(clashes_type), intent(inout) :: clashes
      integer, intent(in) :: element(:)

      real(wp) :: depth
      integer :: i, j, n

      do i = 2, size(element)
         do j = 1, i - 1
            associate (a => element(i), b => element(j))
               if (clashes%part(a) == clashes%part(b)) cycle
               if (any(clashes%low(:, a) >= clashes%high(:, b))) cycle
               if (any(clashes%low(:, b) >= clashes%high(:, a))) cycle
               depth = common_depth(clashes%corner(:, :, a), clashes%corner(:, :, b))
               if (.not. depth > clashes%least) cycle
               n = clashes%n
               call append(clashes%depth, n, depth)
               call append(clashes%pair, clashes%n, [a, b])
            end associate
         end do
      end do
   end subroutine try_all

   !> Shortest shift that parts two triangles [m]; zero or less if they are apart.
   pure function common_depth(p, q) result(depth)
      real(wp), intent(in) :: p(2, 3)        !! corners, counter-clockwise [m]
      real(wp), intent(in) :: q(2, 3)
      real(wp) :: depth

      depth = min(depth_behind(p, q), depth_behind(q, p))
   end function common_depth

   !> How far a triangle is behind that edge of another which it is least behind [m].
   pure function depth_behind(p, q) result(depth)
      real(wp), intent(in) :: p(2, 3)        !! corners, counter-clockwise [m]
      real(wp), intent(in) :: q(2, 3)
      real(wp) :: depth

      depth = minval(max(distances_behind(p, q(:, 1)), distances_behind(p, q(:, 2)), &
         distances_behind(p, q(:, 3))))
   end function depth_behind

   !> How far a point is behind each edge of a triangle [m], negative in front of it.
   pure function distances_behind(corner, x) result(distance)
      real(wp), intent(in) :: corner(2, 3)   !! counter-clockwise [m]
      real(wp), intent(in) :: x(2)           !! [m]
      real(wp) :: distance(3)                !! edge k starts at corner k

      real(wp) :: along(2), arm(2)
      integer :: k

      do k = 1, 3
         along = corner(:, modulo(k, 3) + 1) - corner(:, k)
         arm = x - corner(:, k)
         distance(k) = (along(1)*arm(2) - along(2)*arm(1))/norm2(along)
      end do
   end function distances_behind

end module lithofrac_contact_clashes
