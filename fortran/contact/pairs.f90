!> Pairs that may close in this step: who touches whom, along which normal, how far away.
!>
!> Two passes of node against edge (each side's nodes against the other side's edges), and node
!> against node where both stand nearly at one place. A pair near a node replaces the node's
!> pairs with the edges that end there. Reactions act where the node stands, so that a pair
!> without friction has no moment.
module lithofrac_contact_pairs
   use lithofrac_base_kinds, only: wp
   use lithofrac_contact_corners, only: after_first, after_second, before_first, before_second, &
      both_faces, flat_face, no_corner
   use lithofrac_contact_surfaces, only: offset, surfaces_type
   implicit none
   private

   public :: corner_pair, corner_reach, edge_pair, motion_type, pair_type

   real(wp), parameter :: reach = 0.1_wp          !! gaps beyond it are left out, over h
   real(wp), parameter :: depth = 0.01_wp         !! deeper is not behind this face, over h
   real(wp), parameter :: corner_reach = 0.02_wp  !! two nodes make a corner within it, over h
   real(wp), parameter :: inside = 1.0e-6_wp      !! a node is over an edge from here on
   real(wp), parameter :: separate = 1.0e-9_wp    !! a normal separates above minus this, over h
   real(wp), parameter :: largest_share = 0.5_wp  !! of a reaction on a corner's neighbours
   real(wp), parameter :: turned = 1.0e-3_wp      !! faces closer than this are one plane [rad]
   real(wp), parameter :: opposite = -0.9998_wp   !! cosine of a turn that only a crack tip has

   !> What the sweeps read of a boundary node; small, so that it stays in the cache.
   type :: motion_type
      real(wp) :: v(2) = 0.0_wp               !! velocity without contact, then with [m/s]
      real(wp) :: inverse_mass(2) = 0.0_wp    !! [1/kg]
   end type motion_type

   !> One pair; kept together, and small, because every sweep reads all of it.
   type :: pair_type
      integer :: node(4) = 0                  !! boundary nodes; without weight where not needed
      integer :: n_nodes = 3                  !! 3 or 4
      integer :: n_faces = 0                  !! 0: not a pair of now
      integer :: candidate = 0                !! corner when positive, node and edge when negative
      logical :: is_queued = .false.          !! has to be solved again
      real(wp) :: weight(4) = 0.0_wp          !! relative velocity is sum(weight*v)
      real(wp) :: normal(2, 2) = 0.0_wp       !! (component, face), unit
      real(wp) :: rest(2) = 0.0_wp            !! relative velocity that just closes all faces [m/s]
      real(wp) :: stiffness(2) = 0.0_wp       !! impulse for a change of it, > 0 [kg]
      real(wp) :: friction = 0.0_wp
      real(wp) :: impulse(2) = 0.0_wp         !! of this step [N s]
   end type pair_type

contains

   !> Node `i` against edge `j`.
   pure subroutine edge_pair(surfaces, i, j, pair, gap)
      type(surfaces_type), intent(in) :: surfaces
      integer, intent(in) :: i
      integer, intent(in) :: j
      type(pair_type), intent(inout) :: pair   !! `n_faces` 0 when they cannot touch now
      real(wp), intent(out) :: gap             !! [m]

      real(wp) :: x, y, share

      pair%n_faces = 0
      x = (surfaces%reference(1, i) - surfaces%reference(1, j)) + (surfaces%u(1, i) &
         - surfaces%u(1, j))
      y = (surfaces%reference(2, i) - surfaces%reference(2, j)) + (surfaces%u(2, i) &
         - surfaces%u(2, j))
      associate (tangent => surfaces%tangent(:, j), h => surfaces%h)
         gap = x*tangent(2) - y*tangent(1)
         if (.not. (gap >= -depth*h .and. gap <= reach*h)) return
         share = (x*tangent(1) + y*tangent(2))/surfaces%length(j)
         if (share < inside .or. share > 1.0_wp - inside) return
         if (gap < 0.0_wp) then
            if (is_outside_neighbour(surfaces, i, j, gap)) return
         end if
         pair%n_faces = 1
         pair%n_nodes = 3
         pair%node(1) = i
         pair%node(2) = j
         pair%node(3) = surfaces%next(j)
         pair%node(4) = j
         pair%weight(1) = 1.0_wp
         pair%weight(2) = share - 1.0_wp
         pair%weight(3) = -share
         pair%normal(1, 1) = tangent(2)
         pair%normal(2, 1) = -tangent(1)
      end associate
   end subroutine edge_pair

   !> Behind edge `j` but less far behind the next face round a convex corner: then the node is
   !> outside through that face and does not violate edge `j`. Where the next face runs back the way
   !> of this one there is no corner but the tip of a crack: closed faces may cross by rounding, and
   !> whoever stands before one of them stands behind the other.
   pure function is_outside_neighbour(surfaces, i, j, gap) result(is_outside)
      type(surfaces_type), intent(in) :: surfaces
      integer, intent(in) :: i
      integer, intent(in) :: j
      real(wp), intent(in) :: gap
      logical :: is_outside

      integer :: side, edge

      is_outside = .true.
      do side = 1, 2
         edge = merge(surfaces%prev(j), surfaces%next(j), side == 1)
         ! At the tip of a crack the next face is the node's own.
         if (edge == i .or. surfaces%next(edge) == i) cycle
         associate (t => surfaces%tangent(:, j), s => surfaces%tangent(:, edge))
            if ((s(1)*t(2) - s(2)*t(1))*merge(1, -1, side == 1) <= 0.0_wp) cycle
            if (s(1)*t(1) + s(2)*t(2) < opposite) cycle
            if (across(offset(surfaces, i, edge), s) > gap) return
         end associate
      end do
      is_outside = .false.
   end function is_outside_neighbour

   pure function across(arm, tangent) result(gap)
      real(wp), intent(in) :: arm(2)
      real(wp), intent(in) :: tangent(2)
      real(wp) :: gap

      gap = arm(1)*tangent(2) - arm(2)*tangent(1)
   end function across

   !> Node `i` against node `k`, whose wedges are of `kind` with limiting faces `face`.
   pure subroutine corner_pair(surfaces, i, k, kind, face, arm, predicted, pair, gap)
      type(surfaces_type), intent(in) :: surfaces
      integer, intent(in) :: i
      integer, intent(in) :: k
      integer, intent(in) :: kind
      integer, intent(in) :: face(2)
      real(wp), intent(in) :: arm(2)         !! offset from k to i [m]
      real(wp), intent(in) :: predicted(2)   !! the same after the step, unhindered [m]
      type(pair_type), intent(inout) :: pair !! `n_faces` 0 when they cannot touch now
      real(wp), intent(out) :: gap(2)        !! [m]

      real(wp) :: normal(2, 2), chosen(2)
      integer :: use_face

      pair%n_faces = 0
      gap = 0.0_wp
      if (kind == no_corner) return
      normal(:, 1) = face_normal(surfaces, i, k, face(1))
      normal(:, 2) = face_normal(surfaces, i, k, face(2))
      select case (kind)
      case (both_faces)
         gap = arm(1)*normal(1, :) + arm(2)*normal(2, :)
         if (is_in_reach(surfaces, gap(1)) .and. is_in_reach(surfaces, gap(2))) then
            call stand_at_two_faces(surfaces, i, k, face, arm, pair)
            pair%normal = normal
         else if (is_in_reach(surfaces, gap(1))) then
            call stand_at_face(surfaces, i, k, face(1), arm, normal(:, 1), pair)
         else if (is_in_reach(surfaces, gap(2))) then
            call stand_at_face(surfaces, i, k, face(2), arm, normal(:, 2), pair)
            gap(1) = gap(2)
         end if
         return
      case (flat_face)
         use_face = merge(face(2), face(1), is_over(surfaces, i, k, face(2), arm))
         chosen = face_normal(surfaces, i, k, use_face)
         if (abs(normal(1, 1)*normal(2, 2) - normal(2, 1)*normal(1, 2)) > turned) then
            chosen = unit(normal(:, 1) + normal(:, 2))
         end if
      case default
         call choose_normal(surfaces, normal, face, arm, predicted, chosen, use_face)
         if (dot_product(chosen, arm) < -separate*surfaces%h) then
            call choose_normal(surfaces, normal, face, arm, arm, chosen, use_face)
         end if
      end select
      gap(1) = dot_product(arm, chosen)
      if (is_in_reach(surfaces, gap(1))) then
         call stand_at_face(surfaces, i, k, use_face, arm, chosen, pair)
      end if
   end subroutine corner_pair

   !> Of the normals between two limits the one that is kindest to `wanted`: a limit, or the
   !> direction between the nodes when that is between the limits. Others would have a moment.
   pure subroutine choose_normal(surfaces, normal, face, arm, wanted, chosen, use_face)
      type(surfaces_type), intent(in) :: surfaces
      real(wp), intent(in) :: normal(2, 2)   !! the limits
      integer, intent(in) :: face(2)         !! their edges
      real(wp), intent(in) :: arm(2)         !! from the second node to the first [m]
      real(wp), intent(in) :: wanted(2)      !! the same after the step, unhindered [m]
      real(wp), intent(out) :: chosen(2)
      integer, intent(out) :: use_face       !! 0 when it belongs to no edge

      integer :: limit

      limit = merge(2, 1, dot_product(normal(:, 2), wanted) > dot_product(normal(:, 1), wanted))
      use_face = face(limit)
      chosen = normal(:, limit)
      if (sum(arm*arm) <= (separate*surfaces%h)**2) return
      if (normal(1, 1)*arm(2) - normal(2, 1)*arm(1) <= 0.0_wp) return
      if (arm(1)*normal(2, 2) - arm(2)*normal(1, 2) <= 0.0_wp) return
      if (dot_product(unit(arm), wanted) <= dot_product(chosen, wanted)) return
      use_face = 0
      chosen = unit(arm)
   end subroutine choose_normal

   pure function unit(vector)
      real(wp), intent(in) :: vector(2)
      real(wp) :: unit(2)

      unit = vector/sqrt(vector(1)*vector(1) + vector(2)*vector(2))
   end function unit

   pure function is_in_reach(surfaces, gap)
      type(surfaces_type), intent(in) :: surfaces
      real(wp), intent(in) :: gap
      logical :: is_in_reach

      is_in_reach = gap >= -depth*surfaces%h .and. gap <= reach*surfaces%h
   end function is_in_reach

   !> Normal of one of the four edges at a corner, from the second node's side to the first's.
   pure function face_normal(surfaces, i, k, face) result(normal)
      type(surfaces_type), intent(in) :: surfaces
      integer, intent(in) :: i
      integer, intent(in) :: k
      integer, intent(in) :: face
      real(wp) :: normal(2)

      associate (t => surfaces%tangent(:, edge_of(surfaces, i, k, face)))
         normal = [t(2), -t(1)]
      end associate
      if (face == before_first .or. face == after_first) normal = -normal
   end function face_normal

   pure function edge_of(surfaces, i, k, face) result(edge)
      type(surfaces_type), intent(in) :: surfaces
      integer, intent(in) :: i
      integer, intent(in) :: k
      integer, intent(in) :: face
      integer :: edge

      select case (face)
      case (before_first)
         edge = surfaces%prev(i)
      case (after_first)
         edge = i
      case (before_second)
         edge = surfaces%prev(k)
      case default
         edge = k
      end select
   end function edge_of

   !> Does the other node stand over this edge rather than beyond its end at the corner?
   pure function is_over(surfaces, i, k, face, arm)
      type(surfaces_type), intent(in) :: surfaces
      integer, intent(in) :: i
      integer, intent(in) :: k
      integer, intent(in) :: face
      real(wp), intent(in) :: arm(2)         !! from k to i [m]
      logical :: is_over

      real(wp) :: along

      along = dot_product(arm, surfaces%tangent(:, edge_of(surfaces, i, k, face)))
      is_over = merge(along, -along, face == after_second .or. face == before_first) > 0.0_wp
   end function is_over

   !> A pair along one normal, its reaction shared over the edge so that it has no moment;
   !> face 0 is a normal that belongs to no edge.
   pure subroutine stand_at_face(surfaces, i, k, face, arm, normal, pair)
      type(surfaces_type), intent(in) :: surfaces
      integer, intent(in) :: i
      integer, intent(in) :: k
      integer, intent(in) :: face
      real(wp), intent(in) :: arm(2)         !! from k to i [m]
      real(wp), intent(in) :: normal(2)
      type(pair_type), intent(inout) :: pair

      real(wp) :: share, away
      integer :: edge

      pair%n_faces = 1
      pair%normal(:, 1) = normal
      pair%n_nodes = 3
      pair%node = [i, k, k, k]
      pair%weight(:3) = [1.0_wp, -1.0_wp, 0.0_wp]
      if (face == 0) return
      edge = edge_of(surfaces, i, k, face)
      associate (t => surfaces%tangent(:, edge))
         ! where the line along the normal through the other node cuts the edge
         away = across(arm, t)/across(normal, t)
         share = dot_product(arm - away*normal, t)/surfaces%length(edge)
      end associate
      select case (face)
      case (before_first)
         pair%node(3) = edge
         pair%weight(:3) = [1.0_wp - share, -1.0_wp, share]
      case (after_first)
         pair%node(3) = surfaces%next(edge)
         pair%weight(:3) = [1.0_wp + share, -1.0_wp, -share]
      case (before_second)
         pair%node(3) = edge
         pair%weight(:3) = [1.0_wp, -1.0_wp - share, share]
      case default
         pair%node(3) = surfaces%next(edge)
         pair%weight(:3) = [1.0_wp, share - 1.0_wp, -share]
      end select
   end subroutine stand_at_face

   !> A pair at both faces of a re-entrant corner; the reaction is shared by the three nodes of
   !> the corner so that it acts where the other node stands.
   pure subroutine stand_at_two_faces(surfaces, i, k, face, arm, pair)
      type(surfaces_type), intent(in) :: surfaces
      integer, intent(in) :: i
      integer, intent(in) :: k
      integer, intent(in) :: face(2)
      real(wp), intent(in) :: arm(2)         !! from k to i [m]
      type(pair_type), intent(inout) :: pair

      real(wp) :: before(2), after(2), share(2), determinant
      integer :: corner

      pair%n_faces = 2
      pair%n_nodes = 3
      pair%node = [i, k, k, k]
      pair%weight(:3) = [1.0_wp, -1.0_wp, 0.0_wp]
      if (face(1) == before_second .and. face(2) == after_second) then
         corner = k
      else if (face(1) == before_first .and. face(2) == after_first) then
         corner = i
      else
         return
      end if
      ! the edges into and out of the corner
      before = -surfaces%length(surfaces%prev(corner))*surfaces%tangent(:, surfaces%prev(corner))
      after = surfaces%length(corner)*surfaces%tangent(:, corner)
      determinant = before(1)*after(2) - before(2)*after(1)
      share = [arm(1)*after(2) - arm(2)*after(1), before(1)*arm(2) - before(2)*arm(1)]
      if (.not. sum(abs(share)) <= largest_share*abs(determinant)) return
      share = share/determinant
      pair%n_nodes = 4
      pair%node(3:4) = [surfaces%prev(corner), surfaces%next(corner)]
      pair%weight(merge(1, 2, corner == i)) = pair%weight(merge(1, 2, corner == i)) + sum(share)
      pair%weight(3:4) = -share
   end subroutine stand_at_two_faces

end module lithofrac_contact_pairs
