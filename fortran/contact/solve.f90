!> Contact of one step: pairs, impulses, and what they did to the energy.
!>
!> Forward increment (position level): the gap at the end of the step must not be negative, and
!> an impulse acts only where it is zero. Exact multipliers have no stiffness, so contact does
!> not lower the stable step.
module lithofrac_contact_solve
   use lithofrac_base_kinds, only: wp
   use lithofrac_contact_contact, only: contact_type, renew_list, statistics_type, turn_corners
   use lithofrac_contact_corners, only: no_corner
   use lithofrac_contact_multipliers, only: relative_velocity, solve_pairs
   use lithofrac_contact_pairs, only: corner_pair, corner_reach, edge_pair, feasible_bias, &
      pair_type
   use lithofrac_contact_search, only: list_is_stale
   use lithofrac_contact_surfaces, only: offset, update_shape
   implicit none
   private

   public :: solve_contact
   public :: solved, prescribed_collision, too_fast, lost

   ! Outcomes of a step.
   integer, parameter :: solved = 0
   integer, parameter :: prescribed_collision = 1  !! bodies that may not yield meet
   integer, parameter :: too_fast = 2              !! a pair may jump over its faces
   integer, parameter :: lost = 3                  !! a position is not finite

   integer, parameter :: usual_sweeps = 50
   integer, parameter :: many_sweeps = 200
   real(wp), parameter :: deep = 1.0e-4_wp         !! penetration that asks for many sweeps, over h
   real(wp), parameter :: accuracy = 1.0e-3_wp     !! of the largest relative velocity
   real(wp), parameter :: fine = 1.0e-7_wp         !! gap that no sweep is worth, over h
   real(wp), parameter :: longest_way = 0.05_wp    !! of a pair in a step, over h
   real(wp), parameter :: steps_ahead = 2.0_wp     !! a fast node makes a corner so long before
   real(wp), parameter :: rigid = 1.0e-8_wp        !! compliance along a normal that is none
   real(wp), parameter :: floor = 1.0e-9_wp        !! of a compliance, over the other component
   real(wp), parameter :: meeting = 1.0e-6_wp      !! overlap of prescribed bodies, over h

   !> What makes a gap large or small.
   type :: scales_type
      real(wp) :: h                                !! shortest edge [m]
      real(wp) :: dt                               !! [s]
      real(wp) :: critical                         !! largest stable step [s]
   end type scales_type

contains

   !> Impulses of one step; `contact%v` holds the velocities without contact, then with it.
   subroutine solve_contact(contact, dt, critical, code, node)
      type(contact_type), intent(inout) :: contact
      real(wp), intent(in) :: dt               !! [s]
      real(wp), intent(in) :: critical         !! largest stable step [s]
      integer, intent(out) :: code
      integer, intent(out) :: node(2)          !! boundary nodes that failed

      integer :: i, sweeps
      logical :: converged

      node = 1
      code = lost
      call update_shape(contact%surfaces)
      if (.not. all(abs(contact%surfaces%tangent) <= 1.5_wp)) return
      if (list_is_stale(contact%candidates, contact%surfaces)) call renew_list(contact)
      call turn_corners(contact)
      contact%work_before = 0.0_wp
      contact%work_after = 0.0_wp
      contact%impulse = 0.0_wp
      contact%fastest = 0.0_wp
      contact%deepest = 0.0_wp
      call collect_pairs(contact, scales_type(contact%surfaces%h, dt, critical), code, node)
      if (code /= solved .or. contact%n_pairs == 0) return
      associate (pairs => contact%pairs(:contact%n_pairs), h => contact%surfaces%h)
         call solve_pairs(pairs, contact%inverse_mass, max(accuracy*contact%fastest, fine*h/dt), &
            merge(many_sweeps, usual_sweeps, contact%deepest > deep*h), contact%v, sweeps, &
            converged)
         contact%fastest = 0.0_wp
         do i = 1, contact%n_pairs
            call book_pair(contact, pairs(i))
            if (contact%fastest*dt <= longest_way*h) cycle
            code = too_fast
            node = pairs(i)%node(:2)
            return
         end do
      end associate
      call count_step(contact%statistics, contact%n_pairs, sweeps, converged, &
         contact%deepest/contact%surfaces%h)
   end subroutine solve_contact

   !> Pairs that may close in this step: corners first, then nodes over edges.
   !>
   !> Wedges that stand side by side make a corner. Where something may stand between them, nodes
   !> over edges keep them apart, and a corner only fills the hole exactly above a node. Where
   !> both have somebody on either side, those keep them apart.
   subroutine collect_pairs(contact, scales, code, node)
      type(contact_type), intent(inout) :: contact
      type(scales_type), intent(in) :: scales
      integer, intent(out) :: code
      integer, intent(out) :: node(2)

      logical :: is_done(0:size(contact%kind))
      integer :: i, beside(contact%surfaces%n)

      code = solved
      contact%n_pairs = 0
      is_done = .false.
      beside = 0
      do i = 1, size(contact%kind)
         if (contact%kind(i) == no_corner .or. .not. contact%neighbours(i)) cycle
         call add_corner(contact, scales, i, is_done(i), code)
         if (code /= solved) exit
         if (.not. is_done(i)) cycle
         associate (corner => contact%candidates%corner(:, i))
            beside(corner) = beside(corner) + 1
         end associate
      end do
      if (code == solved) call add_edges(contact, scales, is_done, code)
      do i = 1, size(contact%kind)
         if (code /= solved) exit
         if (contact%kind(i) == no_corner .or. contact%neighbours(i) .or. is_done(i)) cycle
         if (all(beside(contact%candidates%corner(:, i)) > 1)) cycle
         call add_corner(contact, scales, i, is_done(i), code)
      end do
      node = 1
      if (code /= solved) node = contact%pairs(contact%n_pairs + 1)%node(:2)
      contact%corner_impulse = 0.0_wp
      contact%edge_impulse = 0.0_wp
   end subroutine collect_pairs

   !> Nodes over edges, except where the node makes a corner with an end of the edge.
   subroutine add_edges(contact, scales, is_done, code)
      type(contact_type), intent(inout) :: contact
      type(scales_type), intent(in) :: scales
      logical, intent(inout) :: is_done(0:)  !! corners that have a pair, or pairs at their edges
      integer, intent(inout) :: code

      integer :: i, n_before

      n_before = contact%n_pairs
      do i = 1, size(contact%candidates%edge, 2)
         associate (corner => contact%candidates%corner_at(:, i))
            if (is_done(corner(1)) .or. is_done(corner(2))) cycle
            call edge_pair(contact%surfaces, contact%candidates%edge(1, i), &
               contact%candidates%edge(2, i), contact%pairs(contact%n_pairs + 1))
            call count_in(contact, scales, -i, code)
            if (code /= solved) return
         end associate
      end do
      do i = n_before + 1, contact%n_pairs
         is_done(contact%candidates%corner_at(:, -contact%pairs(i)%candidate)) = .true.
      end do
   end subroutine add_edges

   !> The pair of corner `i`, if its nodes are at one place.
   subroutine add_corner(contact, scales, i, is_corner, code)
      type(contact_type), intent(inout) :: contact
      type(scales_type), intent(in) :: scales
      integer, intent(in) :: i
      logical, intent(out) :: is_corner
      integer, intent(inout) :: code

      real(wp) :: arm(2), d(2)

      associate (a => contact%candidates%corner(1, i), b => contact%candidates%corner(2, i), &
            pair => contact%pairs(contact%n_pairs + 1))
         arm = offset(contact%surfaces, a, b)
         d = contact%before(:, a) - contact%before(:, b)
         is_corner = arm(1)*arm(1) + arm(2)*arm(2) <= max((corner_reach*scales%h)**2, &
            (steps_ahead*scales%dt)**2*(d(1)*d(1) + d(2)*d(2)))
         if (.not. is_corner) return
         d = contact%v(:, a) - contact%v(:, b)
         call corner_pair(contact%surfaces, a, b, contact%kind(i), contact%face(:, i), arm, &
            arm + scales%dt*d, pair)
      end associate
      call count_in(contact, scales, i, code)
   end subroutine add_corner

   !> Complete the pair that stands behind those of the step, and count it in.
   subroutine count_in(contact, scales, candidate, code)
      type(contact_type), intent(inout) :: contact
      type(scales_type), intent(in) :: scales
      integer, intent(in) :: candidate       !! corner when positive, node and edge when negative
      integer, intent(inout) :: code

      real(wp) :: speed, impulse(2)
      logical :: collides

      associate (pair => contact%pairs(contact%n_pairs + 1))
         if (pair%n_faces == 0) return
         pair%candidate = candidate
         if (candidate > 0) then
            pair%friction = contact%corner_friction(candidate)
            impulse = contact%corner_impulse(:, candidate)
         else
            pair%friction = contact%edge_friction(-candidate)
            impulse = contact%edge_impulse(:, -candidate)
         end if
         call complete_pair(pair, scales, contact%inverse_mass, contact%v, impulse, speed, collides)
         if (collides) code = prescribed_collision
         if (collides .or. pair%n_faces == 0) return
         contact%fastest = max(contact%fastest, speed)
         contact%deepest = max(contact%deepest, -minval(pair%gap(:pair%n_faces)))
      end associate
      contact%n_pairs = contact%n_pairs + 1
   end subroutine count_in

   !> Compliance, bias and first guess of a pair; faces along which nothing can yield are dropped.
   pure subroutine complete_pair(pair, scales, inverse_mass, v, impulse, speed, collides)
      type(pair_type), intent(inout) :: pair
      type(scales_type), intent(in) :: scales
      real(wp), intent(in), contiguous :: inverse_mass(:, :)
      real(wp), intent(in), contiguous :: v(:, :)
      real(wp), intent(in) :: impulse(2)   !! normal and tangential, of the step before [N s]
      real(wp), intent(out) :: speed       !! predicted, relative [m/s]
      logical, intent(out) :: collides     !! motions that may not yield meet

      real(wp) :: w(2), d(2), largest
      integer :: k, face

      collides = .false.
      w = 0.0_wp
      do k = 1, pair%n_nodes
         w = w + pair%weight(k)**2*inverse_mass(:, pair%node(k))
      end do
      largest = max(w(1), w(2))
      d = relative_velocity(pair, v)
      speed = max(abs(d(1)), abs(d(2)))
      do face = pair%n_faces, 1, -1
         associate (n => pair%normal(:, face))
            pair%bias(face) = feasible_bias(pair%gap(face), scales%h, scales%dt, scales%critical)
            if (n(1)*n(1)*w(1) + n(2)*n(2)*w(2) > rigid*largest) cycle
            collides = collides .or. (n(1)*d(1) + n(2)*d(2) + pair%bias(face))*scales%dt &
               < -meeting*scales%h
         end associate
         call drop_face(pair, face)
      end do
      pair%compliance = max(w, floor*largest)
      associate (n => pair%normal(:, 1))
         pair%impulse(1) = impulse(1)*n(1) - impulse(2)*n(2)
         pair%impulse(2) = impulse(1)*n(2) + impulse(2)*n(1)
      end associate
   end subroutine complete_pair

   !> Forget a face along which nothing can yield.
   pure subroutine drop_face(pair, face)
      type(pair_type), intent(inout) :: pair
      integer, intent(in) :: face

      if (face == 1 .and. pair%n_faces == 2) then
         pair%normal(:, 1) = pair%normal(:, 2)
         pair%gap(1) = pair%gap(2)
         pair%bias(1) = pair%bias(2)
      end if
      pair%n_faces = pair%n_faces - 1
   end subroutine drop_face

   !> Remember an impulse for the next step; book its work and its share on the nodes.
   pure subroutine book_pair(contact, pair)
      type(contact_type), intent(inout) :: contact
      type(pair_type), intent(in) :: pair

      real(wp) :: p(2), before(2), after(2), pressure(2), friction(2)
      integer :: k

      after = relative_velocity(pair, contact%v)
      contact%fastest = max(contact%fastest, abs(after(1)), abs(after(2)))
      p = pair%impulse
      if (.not. max(abs(p(1)), abs(p(2))) > 0.0_wp) return
      do k = 1, pair%n_nodes
         associate (sum_of => contact%impulse(:, pair%node(k)))
            sum_of(1) = sum_of(1) + pair%weight(k)*p(1)
            sum_of(2) = sum_of(2) + pair%weight(k)*p(2)
         end associate
      end do
      before = relative_velocity(pair, contact%before)
      pressure = pressure_of(pair)
      friction = p - pressure
      contact%work_before(1) = contact%work_before(1) + 0.5_wp*dot_product(pressure, before)
      contact%work_before(2) = contact%work_before(2) + 0.5_wp*dot_product(friction, before)
      contact%work_after(1) = contact%work_after(1) + 0.5_wp*dot_product(pressure, after)
      contact%work_after(2) = contact%work_after(2) + 0.5_wp*dot_product(friction, after)
      associate (n => pair%normal(:, 1))
         p = [n(1)*p(1) + n(2)*p(2), n(1)*p(2) - n(2)*p(1)]
      end associate
      if (pair%candidate > 0) then
         contact%corner_impulse(:, pair%candidate) = p
      else
         contact%edge_impulse(:, -pair%candidate) = p
      end if
   end subroutine book_pair

   !> The part of an impulse that is pressure; the rest is friction.
   !>
   !> At a re-entrant pair of faces an impulse between the two normals is pressure of both. Slip
   !> along one face opens the other, so friction lies outside, on the side of the closed face.
   pure function pressure_of(pair) result(p)
      type(pair_type), intent(in) :: pair
      real(wp) :: p(2)

      real(wp) :: share(2), determinant
      integer :: face

      face = 1
      if (pair%n_faces == 2) then
         associate (n => pair%normal, q => pair%impulse)
            determinant = n(1, 1)*n(2, 2) - n(2, 1)*n(1, 2)
            share = [q(1)*n(2, 2) - q(2)*n(1, 2), n(1, 1)*q(2) - n(2, 1)*q(1)]*determinant
         end associate
         if (all(share >= 0.0_wp)) then
            p = pair%impulse
            return
         end if
         if (share(1) < 0.0_wp) face = 2
      end if
      p = dot_product(pair%impulse, pair%normal(:, face))*pair%normal(:, face)
   end function pressure_of

   pure subroutine count_step(statistics, n_pairs, sweeps, converged, penetration)
      type(statistics_type), intent(inout) :: statistics
      integer, intent(in) :: n_pairs
      integer, intent(in) :: sweeps
      logical, intent(in) :: converged
      real(wp), intent(in) :: penetration   !! over h

      statistics%penetration = max(statistics%penetration, penetration)
      statistics%pairs_max = max(statistics%pairs_max, n_pairs)
      statistics%steps = statistics%steps + 1
      statistics%sweeps = statistics%sweeps + sweeps
      if (.not. converged) statistics%unconverged = statistics%unconverged + 1
   end subroutine count_step

end module lithofrac_contact_solve
