!> One crack band, one crack.
!>
!> A band of smeared cracks is one element wide, and the nodes on both of its sides fail with it.
!> The crack on the first side takes the damage over; a second one beside it would cut a strip
!> from the rock that is one element thick, for energy that is already spent.
module lithofrac_fracture_one_band
   use lithofrac_base_kinds, only: wp
   use lithofrac_mesh_mesh, only: mesh_type
   use lithofrac_mesh_rings, only: boundary_around, fan_type
   use lithofrac_mesh_split, only: arm_type
   use lithofrac_mesh_topology, only: next_corner, topology_type
   implicit none
   private

   public :: runs_beside_face

   real(wp), parameter :: ahead = 0.9_wp      !! cosine: what lies so near the direction is ahead
   real(wp), parameter :: parallel = 0.8_wp   !! cosine; zig-zags of regular meshes stay above

contains

   !> Would a crack run along the face of another one that is one element away?
   !>
   !> Looks at the elements of the fan that the arms touch: one that has a corner on a crack, to
   !> the side of the direction, where this crack is parallel to it.
   pure function runs_beside_face(mesh, topology, fan, arms, along) result(yes)
      type(mesh_type), intent(in) :: mesh
      type(topology_type), intent(in) :: topology
      type(fan_type), intent(in) :: fan           !! of the node
      type(arm_type), intent(in) :: arms(:)       !! from the node
      real(wp), intent(in) :: along(2)            !! unit vector of the crack
      logical :: yes

      integer :: node, far, i, j, k

      yes = .false.
      node = mesh%triangles(fan%corner(1), fan%element(1))
      do i = 1, size(arms)
         far = 0
         if (.not. arms(i)%through) then
            far = mesh%triangles(arms(i)%edge, arms(i)%element)
            if (far == node) far = mesh%triangles(next_corner(arms(i)%edge), arms(i)%element)
         end if
         do j = 1, fan%n
            if (arms(i)%through) then
               if (fan%element(j) /= arms(i)%element) cycle
            else if (all(fan%rim(j:j + 1) /= far)) then
               cycle
            end if
            do k = j, j + 1
               if (fan%rim(k) == far) cycle
               yes = is_face_beside(mesh, topology, node, fan%rim(k), along)
               if (yes) return
            end do
         end do
      end do
   end function runs_beside_face

   !> Does a crack run parallel to a direction through a corner to the side of a node?
   pure function is_face_beside(mesh, topology, node, corner, along) result(yes)
      type(mesh_type), intent(in) :: mesh
      type(topology_type), intent(in) :: topology
      integer, intent(in) :: node
      integer, intent(in) :: corner
      real(wp), intent(in) :: along(2)
      logical :: yes

      integer :: around(2), i

      yes = .false.
      if (cosine(mesh, node, corner, along) > ahead) return
      call boundary_around(mesh, topology, corner, around(1), around(2))
      do i = 1, 2
         if (around(i) == 0 .or. around(i) == node) cycle
         if (cosine(mesh, corner, around(i), along) < parallel) cycle
         yes = has_copy(mesh, corner)
         if (.not. yes) yes = has_copy(mesh, around(i))
         if (yes) return
      end do
   end function is_face_beside

   !> Has a node been split? Copies keep its reference position to the bit.
   pure function has_copy(mesh, node) result(yes)
      type(mesh_type), intent(in) :: mesh
      integer, intent(in) :: node
      logical :: yes

      integer :: other

      yes = .true.
      do other = 1, mesh%n_nodes
         if (other == node) cycle
         if (all(abs(mesh%nodes(:, other) - mesh%nodes(:, node)) <= 0.0_wp)) return
      end do
      yes = .false.
   end function has_copy

   !> Of the angle between an edge and a unit vector, without sign.
   pure function cosine(mesh, from, to, along) result(value)
      type(mesh_type), intent(in) :: mesh
      integer, intent(in) :: from
      integer, intent(in) :: to
      real(wp), intent(in) :: along(2)
      real(wp) :: value

      real(wp) :: edge(2)

      edge = mesh%nodes(:, to) - mesh%nodes(:, from)
      value = abs(dot_product(edge, along))/norm2(edge)
   end function cosine

end module lithofrac_fracture_one_band
