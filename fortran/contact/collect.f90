!> Pairs of a step: which candidates may close in it, with all that the solution needs of them.
!>
!> Most candidates are far apart, or open by more than any motion of one step: the order of the
!> questions decides what contact costs. Slices of the candidates are looked at in any order, or
!> at the same time; their pairs are put together in the order of the candidates.
module lithofrac_contact_collect
   use lithofrac_base_kinds, only: wp
   use lithofrac_contact_contact, only: contact_type, corner_of_edge
   use lithofrac_contact_corners, only: no_corner
   use lithofrac_contact_pairs, only: corner_pair, corner_reach, edge_pair, motion_type, &
      pair_type
   use lithofrac_contact_slices, only: last_of, most_slices
   implicit none
   private

   public :: collect_pairs, scales_type

   real(wp), parameter :: steps_ahead = 2.0_wp     !! a fast node makes a corner so long before
   real(wp), parameter :: open_steps = 4.0_wp      !! a gap that takes longer to close is open
   real(wp), parameter :: open_gap = 0.01_wp       !! no smaller gap is open, over h
   real(wp), parameter :: recovery = 0.2_wp        !! of a deeper one, in a critical step
   real(wp), parameter :: push = 1.0e-4_wp         !! largest recovery in a critical step, over h
   real(wp), parameter :: rigid = 1.0e-8_wp        !! compliance along a normal that is none
   real(wp), parameter :: floor = 1.0e-2_wp        !! of a compliance, over the other component
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
      real(wp) :: slop                             !! penetration left alone, over h
   end type scales_type

contains

   !> Pairs that may close in this step: corners first, then nodes over edges.
   !>
   !> Wedges that stand side by side make a corner. Where something may stand between them, nodes
   !> over edges keep them apart, and a corner only fills the hole exactly above a node. Where
   !> both have somebody on either side, those keep them apart.
   subroutine collect_pairs(contact, scales, threaded, collides, node)
      type(contact_type), intent(inout) :: contact
      type(scales_type), intent(in) :: scales
      logical, intent(in) :: threaded        !! slices are worth threads
      logical, intent(out) :: collides       !! motions that may not yield meet
      integer, intent(out) :: node(2)        !! where, boundary nodes

      integer :: slice

      !$omp taskloop default(shared) grainsize(1) if(threaded)
      do slice = 1, contact%n_slices
         call add_neighbours(contact, scales, slice)
      end do
      !$omp end taskloop
      call count_beside(contact)
      !$omp taskloop default(shared) grainsize(1) if(threaded)
      do slice = 1, contact%n_slices
         call add_edges(contact, scales, slice)
      end do
      !$omp end taskloop
      !$omp taskloop default(shared) grainsize(1) if(threaded)
      do slice = 1, contact%n_slices
         call add_other_corners(contact, scales, slice)
      end do
      !$omp end taskloop
      slice = findloc(contact%slices(:contact%n_slices)%collision > 0, .true., dim=1)
      collides = slice > 0
      node = 1
      if (collides) node = contact%pairs(contact%slices(slice)%collision)%node(:2)
      call order_pairs(contact)
   end subroutine collect_pairs

   !> Corners of wedges that stand side by side.
   pure subroutine add_neighbours(contact, scales, slice)
      type(contact_type), intent(inout) :: contact
      type(scales_type), intent(in) :: scales
      integer, intent(in) :: slice

      integer :: first, last, i

      first = last_of(size(contact%kind), slice - 1, contact%n_slices) + 1
      last = last_of(size(contact%kind), slice, contact%n_slices)
      contact%keeper(first:last) = nobody
      associate (found => contact%slices(slice))
         found%collision = 0
         found%fastest = 0.0_wp
         found%deepest = 0.0_wp
         found%first(1) = first + slice - 1
         found%last(1) = first + slice - 2
         do i = first, last
            if (contact%kind(i) == no_corner .or. .not. contact%neighbours(i)) cycle
            call add_corner(contact, scales, i, slice, 1)
            if (found%collision > 0) exit
         end do
      end associate
   end subroutine add_neighbours

   !> How many of these corners every node has.
   pure subroutine count_beside(contact)
      type(contact_type), intent(inout) :: contact

      integer :: i

      contact%beside = 0
      do i = 1, size(contact%kind)
         if (contact%keeper(i) == nobody) cycle
         associate (a => contact%candidates%corner(1, i), b => contact%candidates%corner(2, i))
            contact%beside(a) = contact%beside(a) + 1
            contact%beside(b) = contact%beside(b) + 1
         end associate
      end do
   end subroutine count_beside

   !> Nodes over edges, except where the node makes a corner with an end of the edge.
   subroutine add_edges(contact, scales, slice)
      type(contact_type), intent(inout) :: contact
      type(scales_type), intent(in) :: scales
      integer, intent(in) :: slice

      integer :: i, k, m, start, last
      real(wp) :: gap(2)

      gap = 0.0_wp
      associate (list => contact%candidates, keeper => contact%keeper, &
            found => contact%slices(slice))
         start = last_of(size(contact%edge_order), slice - 1, contact%n_slices) + 1
         last = last_of(size(contact%edge_order), slice, contact%n_slices)
         found%first(2) = size(contact%kind) + most_slices + start + slice - 1
         found%last(2) = found%first(2) - 1
         if (last < start) return
         do k = corner_of_edge(list, contact%edge_order(start)), size(contact%kind)
            if (contact%first_edge(k) > last) return
            if (keeper(k) == corner) cycle
            do m = max(start, contact%first_edge(k)), min(last, contact%first_edge(k + 1) - 1)
               i = contact%edge_order(m)
               associate (one => list%corner_at(1, i), other => list%corner_at(2, i))
                  if (keeper(one) == corner .or. keeper(other) == corner) cycle
                  associate (pair => contact%pairs(found%last(2) + 1))
                     call edge_pair(contact%surfaces, list%edge(1, i), list%edge(2, i), pair, &
                        gap(1))
                     if (pair%n_faces == 0) cycle
                  end associate
                  call keep_by_edge(keeper, one)
                  call keep_by_edge(keeper, other)
               end associate
               call count_in(contact, scales, -i, contact%edge_friction(i), &
                  contact%edge_impulse(:, i), gap, slice, 2)
               if (found%collision > 0) return
            end do
         end do
      end associate
   end subroutine add_edges

   !> Pairs of several slices may say so of one corner.
   subroutine keep_by_edge(keeper, i)
      integer, intent(inout) :: keeper(0:)
      integer, intent(in) :: i                !! corner; 0 for none

      if (i == 0) return
      !$omp atomic write
      keeper(i) = edge
   end subroutine keep_by_edge

   !> Corners that nobody keeps apart yet.
   pure subroutine add_other_corners(contact, scales, slice)
      type(contact_type), intent(inout) :: contact
      type(scales_type), intent(in) :: scales
      integer, intent(in) :: slice

      integer :: i

      associate (found => contact%slices(slice))
         found%first(3) = found%last(1) + 1
         found%last(3) = found%last(1)
         do i = last_of(size(contact%kind), slice - 1, contact%n_slices) + 1, &
            last_of(size(contact%kind), slice, contact%n_slices)
            if (found%collision > 0) exit
            if (contact%kind(i) == no_corner .or. contact%neighbours(i) &
               .or. contact%keeper(i) /= nobody) cycle
            if (min(contact%beside(contact%candidates%corner(1, i)), &
               contact%beside(contact%candidates%corner(2, i))) > 1) cycle
            call add_corner(contact, scales, i, slice, 3)
         end do
      end associate
   end subroutine add_other_corners

   !> The pair of corner `i`, if its nodes are at one place.
   pure subroutine add_corner(contact, scales, i, slice, pass)
      type(contact_type), intent(inout) :: contact
      type(scales_type), intent(in) :: scales
      integer, intent(in) :: i
      integer, intent(in) :: slice
      integer, intent(in) :: pass

      real(wp) :: arm(2), d(2), gap(2)
      integer :: k

      associate (a => contact%candidates%corner(1, i), b => contact%candidates%corner(2, i), &
            surfaces => contact%surfaces, &
            pair => contact%pairs(contact%slices(slice)%last(pass) + 1))
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
         gap, slice, pass)
   end subroutine add_corner

   !> Complete the pair that stands behind those of the pass, and count it in unless it is open.
   pure subroutine count_in(contact, scales, candidate, friction, impulse, gap, slice, pass)
      type(contact_type), intent(inout) :: contact
      type(scales_type), intent(in) :: scales
      integer, intent(in) :: candidate       !! corner when positive, node and edge when negative
      real(wp), intent(in) :: friction
      real(wp), intent(in) :: impulse(2)     !! normal and tangential, of the step before [N s]
      real(wp), intent(in) :: gap(2)         !! [m]
      integer, intent(in) :: slice
      integer, intent(in) :: pass

      real(wp) :: least, d(2)
      logical :: collides

      associate (found => contact%slices(slice))
         associate (pair => contact%pairs(found%last(pass) + 1))
            least = gap(1)
            if (pair%n_faces == 2) least = min(least, gap(2))
            if (least > max(open_gap*scales%h, open_steps*scales%dt*scales%speed)) return
            pair%candidate = candidate
            pair%friction = friction
            call complete_pair(pair, scales, contact%motion, gap, d, collides)
            if (collides) found%collision = found%last(pass) + 1
            if (collides .or. pair%n_faces == 0) return
            pair%impulse(1) = impulse(1)*pair%normal(1, 1) - impulse(2)*pair%normal(2, 1)
            pair%impulse(2) = impulse(1)*pair%normal(2, 1) + impulse(2)*pair%normal(1, 1)
            if (contact%n_groups > 1) contact%pair_group(found%last(pass) + 1) &
               = contact%group_of(pair%node(1))
         end associate
         found%fastest = max(found%fastest, abs(d(1)), abs(d(2)))
         found%deepest = max(found%deepest, -least)
         found%last(pass) = found%last(pass) + 1
      end associate
   end subroutine count_in

   !> Order of the pairs: by group of islands, in each as the candidates.
   pure subroutine order_pairs(contact)
      type(contact_type), intent(inout) :: contact

      integer :: place(contact%n_groups), group, i, pass, slice

      contact%groups%last = 0
      associate (slices => contact%slices, groups => contact%groups)
         do slice = 1, contact%n_slices
            do pass = 1, 3
               if (contact%n_groups == 1) then
                  groups(1)%last = groups(1)%last + slices(slice)%last(pass) &
                     - slices(slice)%first(pass) + 1
                  cycle
               end if
               do i = slices(slice)%first(pass), slices(slice)%last(pass)
                  associate (last => groups(contact%pair_group(i))%last)
                     last = last + 1
                  end associate
               end do
            end do
         end do
         contact%n_pairs = 0
         do group = 1, contact%n_groups
            groups(group)%first = contact%n_pairs + 1
            place(group) = groups(group)%first
            contact%n_pairs = contact%n_pairs + groups(group)%last
            groups(group)%last = contact%n_pairs
         end do
         group = 1
         do pass = 1, 3
            do slice = 1, contact%n_slices
               do i = slices(slice)%first(pass), slices(slice)%last(pass)
                  if (contact%n_groups > 1) group = contact%pair_group(i)
                  contact%order(place(group)) = i
                  place(group) = place(group) + 1
               end do
            end do
         end do
      end associate
   end subroutine order_pairs

   !> Stiffness of a pair and where it comes to rest; faces along which nothing can yield go.
   pure subroutine complete_pair(pair, scales, motion, gap, d, collides)
      type(pair_type), intent(inout) :: pair
      type(scales_type), intent(in) :: scales
      type(motion_type), intent(in), contiguous :: motion(:)
      real(wp), intent(in) :: gap(2)       !! [m]
      real(wp), intent(out) :: d(2)        !! predicted relative velocity [m/s]
      logical, intent(out) :: collides     !! motions that may not yield meet

      real(wp) :: w(2), bias(2), largest
      integer :: k, face

      collides = .false.
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
         bias = max(min(0.0_wp, recovery*(gap + scales%slop*scales%h)), -push*scales%h) &
            /scales%critical
      end if
   end function feasible_bias

end module lithofrac_contact_collect
