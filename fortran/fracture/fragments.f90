!> Which elements still hang together.
module lithofrac_fracture_fragments
   use lithofrac_mesh_mesh, only: mesh_type
   use lithofrac_mesh_topology, only: topology_type
   implicit none
   private

   public :: find_parts

contains

   !> Lowest element of the part that each element belongs to; 0 for elements that were cut.
   pure function find_parts(mesh, topology) result(part)
      type(mesh_type), intent(in) :: mesh
      type(topology_type), intent(in) :: topology
      integer :: part(mesh%n_elements)

      integer :: waiting(mesh%n_elements), first, element, other, n, k

      part = 0
      do first = 1, mesh%n_elements
         if (part(first) > 0 .or. .not. topology%alive(first)) cycle
         part(first) = first
         waiting(1) = first
         n = 1
         do while (n > 0)
            element = waiting(n)
            n = n - 1
            do k = 1, 3
               other = topology%neighbour(k, element)
               if (other == 0) cycle
               if (part(other) > 0) cycle
               part(other) = first
               n = n + 1
               waiting(n) = other
            end do
         end do
      end do
   end function find_parts

end module lithofrac_fracture_fragments
