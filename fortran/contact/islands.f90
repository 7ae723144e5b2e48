!> Islands: boundary nodes that no pair of the list joins to others.
!>
!> Impulses of one island do not reach another, so islands are solved at the same time and the
!> bits are those of one after the other. Islands follow from the list of candidates; they hold
!> as long as it does.
module lithofrac_contact_islands
   use lithofrac_contact_search, only: candidates_type
   use lithofrac_contact_surfaces, only: surfaces_type
   implicit none
   private

   public :: find_islands, group_islands

contains

   !> Island of every boundary node, by the lowest node in it.
   pure subroutine find_islands(surfaces, list, island)
      type(surfaces_type), intent(in) :: surfaces
      type(candidates_type), intent(in) :: list
      integer, intent(out) :: island(:)          !! (n)

      integer :: i

      island = [(i, i=1, size(island))]
      associate (next => surfaces%next, prev => surfaces%prev)
         do i = 1, size(list%corner, 2)
            associate (a => list%corner(1, i), b => list%corner(2, i))
               call join(island, a, b)
               call join(island, a, prev(a))
               call join(island, a, next(a))
               call join(island, b, prev(b))
               call join(island, b, next(b))
            end associate
         end do
         do i = 1, size(list%edge, 2)
            associate (node => list%edge(1, i), edge => list%edge(2, i))
               call join(island, node, edge)
               call join(island, node, next(edge))
            end associate
         end do
      end associate
      ! a node points to one that is not above it, whose island is known by now
      do i = 1, size(island)
         island(i) = island(island(i))
      end do
   end subroutine find_islands

   !> Join the islands of two nodes under the lower root.
   pure subroutine join(parent, i, j)
      integer, intent(inout) :: parent(:)
      integer, intent(in) :: i
      integer, intent(in) :: j

      integer :: root(2), node, k

      do k = 1, 2
         node = merge(i, j, k == 1)
         do while (parent(node) /= node)
            parent(node) = parent(parent(node))
            node = parent(node)
         end do
         root(k) = node
      end do
      parent(maxval(root)) = minval(root)
   end subroutine join

   !> Deal islands out, each to the group that has least; those without weight to the first.
   pure subroutine group_islands(island, weight, n_groups, group)
      integer, intent(in) :: island(:)           !! (n) of every node, by the lowest node in it
      integer, intent(in) :: weight(:)           !! (n) of every node
      integer, intent(in) :: n_groups
      integer, intent(out) :: group(:)           !! (n) of every node

      integer :: load(n_groups), total(size(island)), i, k

      total = 0
      do i = 1, size(island)
         total(island(i)) = total(island(i)) + weight(i)
      end do
      load = 0
      group = 1
      if (n_groups == 1) return
      do i = 1, size(island)
         if (island(i) /= i) then
            group(i) = group(island(i))
         else
            k = merge(minloc(load, dim=1), 1, total(i) > 0)
            group(i) = k
            load(k) = load(k) + total(i)
         end if
      end do
   end subroutine group_islands

end module lithofrac_contact_islands
