!> Contact on a boundary that has grown by cracks: impulses stay with their nodes.
module lithofrac_contact_rebuild
   use lithofrac_base_kinds, only: wp
   use lithofrac_base_status, only: ok, status_type
   use lithofrac_contact_contact, only: contact_type, resize_motion
   use lithofrac_contact_surfaces, only: new_surfaces
   use lithofrac_mesh_mesh, only: mesh_type
   implicit none
   private

   public :: rebuild_contact

contains

   !> Take over the boundary of `mesh`. The list of candidates is made anew at the next step;
   !> pairs that go on keep their impulses as a first guess.
   subroutine rebuild_contact(contact, mesh, u, status)
      type(contact_type), intent(inout) :: contact
      type(mesh_type), intent(in) :: mesh         !! living elements only
      real(wp), intent(in) :: u(:, :)             !! (2, n_nodes) displacement of now [m]
      type(status_type), intent(out) :: status

      integer :: i, old(contact%surfaces%n), place(mesh%n_nodes)

      old = contact%surfaces%node
      call new_surfaces(contact%surfaces, mesh, status)
      if (status%code /= ok) return
      associate (surfaces => contact%surfaces, list => contact%candidates)
         place = 0
         place(surfaces%node) = [(i, i=1, surfaces%n)]
         if (list%listed) then
            list%corner = renumbered(place(old), list%corner)
            list%edge = renumbered(place(old), list%edge)
         end if
         list%listed = .false.
         surfaces%u = u(:, surfaces%node)
      end associate
      call resize_motion(contact)
   end subroutine rebuild_contact

   !> Boundary nodes keep their order, so sorted pairs stay sorted.
   pure function renumbered(place, pairs) result(new)
      integer, intent(in) :: place(:)             !! new number of every old boundary node
      integer, intent(in) :: pairs(:, :)          !! (2, n)
      integer :: new(size(pairs, 1), size(pairs, 2))

      integer :: i

      do i = 1, size(pairs, 2)
         new(:, i) = place(pairs(:, i))
      end do
   end function renumbered

end module lithofrac_contact_rebuild
