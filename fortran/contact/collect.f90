!> Pairs of a step: which candidates may close in it, with all that the solution needs of them.
!>
!> Most candidates are far apart, or open by more than any motion of one step: the order of the
!> questions decides what contact costs.
module lithofrac_contact_collect
   use lithofrac_base_kinds, only: wp
   use lithofrac_contact_contact, only: contact_type
   use lithofrac_contact_corners, only: no_corner
   use lithofrac_contact_pairs, only: corner_pair, corner_reach, edge_pair, motion_type, &
      pair_type
   implicit none
   private

   public :: collect_pairs, scales_type

   real(wp), parameter :: steps_ahead = 2.0_wp     !! a fast node makes a corner so long before
   real(wp), parameter :: open_steps = 4.0_wp      !! a gap that takes longer to close is open
   real(wp), parameter :: open_gap = 0.01_wp       !! no smaller gap is open, over h
   real(wp), parameter :: slop = 1.0e-6_wp         !! penetration left alone, over h
   real(wp), parameter :: recovery = 0.2_wp        !! of a deeper one, in a critical step
   real(wp), parameter :: push = 1.0e-4_wp         !! largest recovery in a critical step, over h
   real(wp), parameter :: rigid = 1.0e-8_wp        !! compliance along a normal that is none
   real(wp), parameter :: floor = 1.0e-9_wp        !! of a compliance, over the other component
   real(wp), parameter :: meeting = 1.0e-6_wp      !! overlap of prescribed bodies, over h
   real(wp), parameter :: parallel = 1.0e-9_wp     !! sine of the angle of normals that are one

   ! Who keeps the two nodes of a corner apart.
   integer, parameter :: nobody = 0
   integer, parameter :: corner = 1                !! their own pair
   integer, parameter :: edge = 2                  !! a pair of one of them with an edge

   !> What makes a gap large or small.
   type :: scales_type
      real(wp) :: h                                !! shortest edge [m]
      real(wp) :: dt                               !! [s]
      real(wp) :: critical                         !! largest stable step [s]
      real(wp) :: speed                            !! of the fastest node, without contact [m/s]
   end type scales_type

contains

   !> Pairs that may close in this step: corners first, then nodes over edges.
   !>
   !> Wedges that stand side by side make a corner. Where something may stand between them, nodes
   !> over edges keep them apart, and a corner only fills the hole exactly above a node. Where
   !> both have somebody on either side, those keep them apart.
   subroutine collect_pairs(contact, scales, collides, node)
      type(contact_type), intent(inout) :: contact
      type(scales_type), intent(in) :: scales
      logical, intent(out) :: collides       !! motions that may not yield meet
      integer, intent(out) :: node(2)        !! where, boundary nodes

      integer :: i

      collides = .false.
      contact%n_pairs = 0
      contact%keeper = nobody
      contact%beside = 0
      do i = 1, size(contact%kind)
         if (contact%kind(i) == no_corner .or. .not. contact%neighbours(i)) cycle
         call add_corner(contact, scales, i, collides)
         if (collides) exit
         if (contact%keeper(i) == nobody) cycle
         associate (a => contact%candidates%corner(1, i), b => contact%candidates%corner(2, i))
            contact%beside(a) = contact%beside(a) + 1
            contact%beside(b) = contact%beside(b) + 1
         end associate
      end do
      if (.not. collides) call add_edges(contact, scales, collides)
      do i = 1, size(contact%kind)
         if (collides) exit
         if (contact%kind(i) == no_corner .or. contact%neighbours(i) &
            .or. contact%keeper(i) /= nobody) cycle
         if (min(contact%beside(contact%candidates%corner(1, i)), &
            contact%beside(contact%candidates%corner(2, i))) > 1) cycle
         call add_corner(contact, scales, i, collides)
      end do
      node = 1
      if (collides) node = contact%pairs(contact%n_pairs + 1)%node(:2)
   end subroutine collect_pairs

   !> Nodes over edges, except where the node makes a corner with an end of the edge.
   subroutine add_edges(contact, scales, collides)
      type(contact_type), intent(inout) :: contact
      type(scales_type), intent(in) :: scales
      logical, intent(inout) :: collides

      integer :: i, k, m
      real(wp) :: gap(2)

      gap = 0.0_wp
      associate (list => contact%candidates, keeper => contact%keeper)
         do k = 0, size(contact%kind)
            if (keeper(k) == corner) cycle
            do m = contact%first_edge(k), contact%first_edge(k + 1) - 1
               i = contact%edge_order(m)
               associate (one => list%corner_at(1, i), other => list%corner_at(2, i))
                  if (keeper(one) == corner .or. keeper(other) == corner) cycle
                  associate (pair => contact%pairs(contact%n_pairs + 1))
                     call edge_pair(contact%surfaces, list%edge(1, i), list%edge(2, i), pair, &
                        gap(1))
                     if (pair%n_faces == 0) cycle
                  end associate
                  keeper(one) = edge
                  keeper(other) = edge
               end associate
               call count_in(contact, scales, -i, contact%edge_friction(i), &
                  contact%edge_impulse(:, i), gap, collides)
               if (collides) return
            end do
         end do
      end associate
   end subroutine add_edges

   !> The pair of corner `i`, if its nodes are at one place.
   subroutine add_corner(contact, scales, i, collides)
      type(contact_type), intent(inout) :: contact
      type(scales_type), intent(in) :: scales
      integer, intent(in) :: i
      logical, intent(inout) :: collides

      real(wp) :: arm(2), d(2), gap(2)
      integer :: k

      associate (a => contact%candidates%corner(1, i), b => contact%candidates%corner(2, i), &
            surfaces => contact%surfaces, pair => contact%pairs(contact%n_pairs + 1))
         do k = 1, 2
            arm(k) = (surfaces%reference(k, a) - surfaces%reference(k, b)) &
               + (surfaces%u(k, a) - surfaces%u(k, b))
         end do
         if (arm(1)*arm(1) + arm(2)*arm(2) > (corner_reach*scales%h)**2) then
            d = contact%record(a)%before - contact%record(b)%before
            if (arm(1)*arm(1) + arm(2)*arm(2) > (steps_ahead*scales%dt)**2 &
               *(d(1)*d(1) + d(2)*d(2))) return
         end if
         contact%keeper(i) = corner
         do k = 1, 2
            d(k) = arm(k) + scales%dt*(contact%motion(a)%v(k) - contact%motion(b)%v(k))
         end do
         call corner_pair(surfaces, a, b, contact%kind(i), contact%face(:, i), arm, d, pair, &
            gap)
         if (pair%n_faces == 0) return
      end associate
      call count_in(contact, scales, i, contact%corner_friction(i), contact%corner_impulse(:, i), &
         gap, collides)
   end subroutine add_corner

   !> Complete the pair that stands behind those of the step, and count it in unless it is open.
   subroutine count_in(contact, scales, candidate, friction, impulse, gap, collides)
      type(contact_type), intent(inout) :: contact
      type(scales_type), intent(in) :: scales
      integer, intent(in) :: candidate       !! corner when positive, node and edge when negative
      real(wp), intent(in) :: friction
      real(wp), intent(in) :: impulse(2)     !! normal and tangential, of the step before [N s]
      real(wp), intent(in) :: gap(2)         !! [m]
      logical, intent(inout) :: collides

      real(wp) :: least, d(2)

      associate (pair => contact%pairs(contact%n_pairs + 1))
         least = gap(1)
         if (pair%n_faces == 2) least = min(least, gap(2))
         if (least > max(open_gap*scales%h, open_steps*scales%dt*scales%speed)) return
         pair%candidate = candidate
         pair%friction = friction
         call complete_pair(pair, scales, contact%motion, gap, d, collides)
         if (collides .or. pair%n_faces == 0) return
         pair%impulse(1) = impulse(1)*pair%normal(1, 1) - impulse(2)*pair%normal(2, 1)
         pair%impulse(2) = impulse(1)*pair%normal(2, 1) + impulse(2)*pair%normal(1, 1)
         contact%fastest = max(contact%fastest, abs(d(1)), abs(d(2)))
         contact%deepest = max(contact%deepest, -least)
      end associate
      contact%n_pairs = contact%n_pairs + 1
   end subroutine count_in

   !> Stiffness of a pair and where it comes to rest; faces along which nothing can yield go.
   pure subroutine complete_pair(pair, scales, motion, gap, d, collides)
      type(pair_type), intent(inout) :: pair
      type(scales_type), intent(in) :: scales
      type(motion_type), intent(in), contiguous :: motion(:)
      real(wp), intent(in) :: gap(2)       !! [m]
      real(wp), intent(out) :: d(2)        !! predicted relative velocity [m/s]
      logical, intent(inout) :: collides   !! motions that may not yield meet

      real(wp) :: w(2), bias(2), largest
      integer :: k, face

      d = 0.0_wp
      w = 0.0_wp
      do k = 1, pair%n_nodes
         associate (at => motion(pair%node(k)), weight => pair%weight(k))
            d(1) = d(1) + weight*at%v(1)
            d(2) = d(2) + weight*at%v(2)
            w(1) = w(1) + weight*weight*at%inverse_mass(1)
            w(2) = w(2) + weight*weight*at%inverse_mass(2)
         end associate
      end do
      largest = max(w(1), w(2))
      bias(1) = feasible_bias(gap(1), scales)
      if (pair%n_faces == 2) bias(2) = feasible_bias(gap(2), scales)
      do face = pair%n_faces, 1, -1
         associate (n => pair%normal(:, face))
            if (n(1)*n(1)*w(1) + n(2)*n(2)*w(2) > rigid*largest) cycle
            collides = collides .or. (n(1)*d(1) + n(2)*d(2) + bias(face))*scales%dt &
               < -meeting*scales%h
         end associate
         call drop_face(pair, face, bias)
      end do
      pair%stiffness(1) = 1.0_wp/max(w(1), floor*largest)
      pair%stiffness(2) = 1.0_wp/max(w(2), floor*largest)
      call set_rest(pair, bias)
   end subroutine complete_pair

   !> Forget a face.
   pure subroutine drop_face(pair, face, bias)
      type(pair_type), intent(inout) :: pair
      integer, intent(in) :: face
      real(wp), intent(inout) :: bias(2)

      if (face == 1 .and. pair%n_faces == 2) then
         pair%normal(:, 1) = pair%normal(:, 2)
         bias(1) = bias(2)
      end if
      pair%n_faces = pair%n_faces - 1
   end subroutine drop_face

   !> Relative velocity that closes the gaps of all faces and no more; of two faces that are one
   !> the nearer counts.
   pure subroutine set_rest(pair, bias)
      type(pair_type), intent(inout) :: pair
      real(wp), intent(inout) :: bias(2)   !! speed that the gaps may still have [m/s]

      real(wp) :: determinant

      associate (n => pair%normal)
         if (pair%n_faces == 2) then
            determinant = n(1, 1)*n(2, 2) - n(2, 1)*n(1, 2)
            if (abs(determinant) >= parallel) then
               pair%rest(1) = (n(2, 1)*bias(2) - n(2, 2)*bias(1))/determinant
               pair%rest(2) = (n(1, 2)*bias(1) - n(1, 1)*bias(2))/determinant
               return
            end if
            call drop_face(pair, merge(2, 1, bias(1) <= bias(2)), bias)
         end if
         pair%rest(1) = -bias(1)*n(1, 1)
         pair%rest(2) = -bias(1)*n(2, 1)
      end associate
   end subroutine set_rest

   !> Speed that a closed gap may still have [m/s].
   !>
   !> A tiny penetration asks for no recovery, so standing still is always a solution; a deeper
   !> one is taken back gently, without a kick, as fast at any step.
   pure function feasible_bias(gap, scales) result(bias)
      real(wp), intent(in) :: gap   !! [m]
      type(scales_type), intent(in) :: scales
      real(wp) :: bias

      if (gap >= 0.0_wp) then
         bias = gap/scales%dt
      else
         bias = max(min(0.0_wp, recovery*(gap + slop*scales%h)), -push*scales%h)/scales%critical
      end if
   end function feasible_bias

end module lithofrac_contact_collect
