!> Contact of one step: list, pairs, impulses, and what they did to the energy.
!>
!> Forward increment (position level): the gap at the end of the step must not be negative, and
!> an impulse acts only where it is zero. Exact multipliers have no stiffness, so contact does
!> not lower the stable step. This module knows boundary nodes only; `run` brings their motion.
module lithofrac_contact_contact
   use lithofrac_base_kinds, only: wp
   use lithofrac_base_status, only: bad_input, ok, set_failure, status_type
   use lithofrac_contact_corners, only: classify, no_corner
   use lithofrac_contact_multipliers, only: relative_velocity, solve_pairs
   use lithofrac_contact_pairs, only: corner_pair, corner_reach, edge_pair, feasible_bias, &
      pair_type
   use lithofrac_contact_search, only: candidates_type, list_candidates, list_is_stale
   use lithofrac_contact_surfaces, only: new_surfaces, offset, surfaces_type, update_shape
   use lithofrac_mesh_mesh, only: mesh_type
   implicit none
   private

   public :: contact_type, new_contact, prepare_list, solve_contact
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
   real(wp), parameter :: rotated = 1.0e-6_wp      !! squared turn that asks for new corners [rad2]

   type :: statistics_type
      integer :: pairs_max = 0
      integer :: steps = 0                         !! with at least one pair
      integer :: sweeps = 0
      integer :: unconverged = 0                   !! steps
      integer :: lists = 0                         !! times the list was made
      real(wp) :: penetration = 0.0_wp             !! deepest, over h
   end type statistics_type

   !> What makes a gap large or small.
   type :: scales_type
      real(wp) :: h                                !! shortest edge [m]
      real(wp) :: dt                               !! [s]
      real(wp) :: critical                         !! largest stable step [s]
   end type scales_type

   type :: contact_type
      logical :: on = .false.
      type(surfaces_type) :: surfaces
      real(wp), allocatable :: friction(:, :)      !! (n_tags, n_tags)
      type(candidates_type) :: candidates
      integer, allocatable :: kind(:)              !! (n_corners)
      integer, allocatable :: face(:, :)           !! (2, n_corners)
      logical, allocatable :: neighbours(:)        !! (n_corners) nothing stands between
      real(wp), allocatable :: corner_friction(:)  !! (n_corners)
      real(wp), allocatable :: edge_friction(:)    !! (n_edges)
      real(wp), allocatable :: tangent(:, :)       !! (2, n) edges when corners were classified
      real(wp), allocatable :: corner_impulse(:, :)  !! (2, n_corners) normal, tangential [N s]
      real(wp), allocatable :: edge_impulse(:, :)  !! (2, n_edges)
      type(pair_type), allocatable :: pairs(:)     !! room for every candidate
      integer :: n_pairs = 0
      real(wp), allocatable :: inverse_mass(:, :)  !! (2, n) [1/kg]
      real(wp), allocatable :: before(:, :)        !! (2, n) velocity at the half step before [m/s]
      real(wp), allocatable :: v(:, :)             !! (2, n) and after it [m/s]
      real(wp), allocatable :: impulse(:, :)       !! (2, n) sum on the node [N s]
      real(wp) :: work_before(2) = 0.0_wp          !! normal, friction: half step before [J]
      real(wp) :: work_after(2) = 0.0_wp           !! and after [J]
      real(wp) :: fastest = 0.0_wp                 !! relative velocity of a pair in this step [m/s]
      real(wp) :: deepest = 0.0_wp                 !! penetration of a pair in this step [m]
      type(statistics_type) :: statistics
   end type contact_type

contains

   !> Prepare the boundary of a mesh for contact.
   subroutine new_contact(contact, mesh, friction, status)
      type(contact_type), intent(out) :: contact
      type(mesh_type), intent(in) :: mesh
      real(wp), intent(in) :: friction(:, :)   !! by surface tag; bodies are the first tags
      type(status_type), intent(out) :: status

      if (size(friction, 1) < mesh%n_bodies) then
         call set_failure(status, bad_input, "contact: a body has no friction")
      else if (.not. all(friction >= 0.0_wp .and. friction <= huge(1.0_wp))) then
         call set_failure(status, bad_input, "contact: friction is a finite number >= 0")
      else if (any(abs(friction - transpose(friction)) > 0.0_wp)) then
         call set_failure(status, bad_input, "contact: friction must be symmetric")
      end if
      if (status%code /= ok) return
      call new_surfaces(contact%surfaces, mesh, status)
      if (status%code /= ok) return
      contact%friction = friction
      associate (n => contact%surfaces%n)
         allocate (contact%inverse_mass(2, n), contact%before(2, n), source=0.0_wp)
         allocate (contact%v(2, n), contact%impulse(2, n), source=0.0_wp)
      end associate
      contact%tangent = contact%surfaces%tangent
      contact%candidates%u = contact%surfaces%u
      contact%on = .true.
   end subroutine new_contact

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

   !> A new list of candidates; impulses go along.
   subroutine renew_list(contact)
      type(contact_type), intent(inout) :: contact

      type(candidates_type) :: old
      real(wp), allocatable :: corner_impulse(:, :), edge_impulse(:, :)

      call move_alloc(contact%candidates%corner, old%corner)
      call move_alloc(contact%candidates%edge, old%edge)
      if (allocated(old%corner)) then
         call move_alloc(contact%corner_impulse, corner_impulse)
         call move_alloc(contact%edge_impulse, edge_impulse)
      end if
      contact%tangent = contact%surfaces%tangent
      call prepare_list(contact)
      if (allocated(old%corner)) then
         call carry_over(old%corner, corner_impulse, contact%candidates%corner, &
            contact%corner_impulse)
         call carry_over(old%edge, edge_impulse, contact%candidates%edge, contact%edge_impulse)
      end if
      contact%statistics%lists = contact%statistics%lists + 1
   end subroutine renew_list

   !> List for `surfaces%u` with corners for `tangent`: all that is not saved in a checkpoint.
   subroutine prepare_list(contact)
      type(contact_type), intent(inout) :: contact

      integer :: n_corners, n_edges, i

      call list_candidates(contact%candidates, contact%surfaces)
      n_corners = size(contact%candidates%corner, 2)
      n_edges = size(contact%candidates%edge, 2)
      if (allocated(contact%kind)) then
         deallocate (contact%kind, contact%face, contact%pairs)
         deallocate (contact%neighbours, contact%corner_friction, contact%edge_friction)
      end if
      allocate (contact%kind(n_corners), contact%face(2, n_corners))
      allocate (contact%neighbours(n_corners))
      allocate (contact%corner_friction(n_corners), contact%edge_friction(n_edges))
      allocate (contact%pairs(n_corners + n_edges + 1))
      contact%corner_impulse = spread([0.0_wp, 0.0_wp], 2, n_corners)
      contact%edge_impulse = spread([0.0_wp, 0.0_wp], 2, n_edges)
      associate (list => contact%candidates, prev => contact%surfaces%prev)
         do i = 1, n_corners
            call classify_corner(contact, i)
            contact%corner_friction(i) = friction_of(contact, [prev(list%corner(1, i)), &
               list%corner(1, i)], [prev(list%corner(2, i)), list%corner(2, i)])
         end do
         do i = 1, n_edges
            contact%edge_friction(i) = friction_of(contact, [prev(list%edge(1, i)), &
               list%edge(1, i)], [list%edge(2, i)])
         end do
      end associate
   end subroutine prepare_list

   !> Copy the values of pairs that are in both lists; both are sorted.
   pure subroutine carry_over(old_pair, old_value, new_pair, new_value)
      integer, intent(in) :: old_pair(:, :)
      real(wp), intent(in) :: old_value(:, :)
      integer, intent(in) :: new_pair(:, :)
      real(wp), intent(inout) :: new_value(:, :)

      integer :: i, k

      k = 1
      do i = 1, size(new_pair, 2)
         do while (k <= size(old_pair, 2))
            if (old_pair(1, k) > new_pair(1, i)) exit
            if (old_pair(1, k) == new_pair(1, i) .and. old_pair(2, k) >= new_pair(2, i)) exit
            k = k + 1
         end do
         if (k > size(old_pair, 2)) exit
         if (all(old_pair(:, k) == new_pair(:, i))) new_value(:, i) = old_value(:, k)
      end do
   end subroutine carry_over

   pure subroutine classify_corner(contact, i)
      type(contact_type), intent(inout) :: contact
      integer, intent(in) :: i

      associate (first => contact%candidates%corner(1, i), t => contact%tangent, &
            second => contact%candidates%corner(2, i), prev => contact%surfaces%prev)
         call classify(t(:, prev(first)), t(:, first), t(:, prev(second)), t(:, second), &
            contact%kind(i), contact%face(:, i), contact%neighbours(i))
      end associate
   end subroutine classify_corner

   !> Classify corners again where an edge has turned since the last time.
   pure subroutine turn_corners(contact)
      type(contact_type), intent(inout) :: contact

      logical :: turned(contact%surfaces%n)
      integer :: i

      associate (t => contact%surfaces%tangent, old => contact%tangent)
         do i = 1, contact%surfaces%n
            turned(i) = (t(1, i) - old(1, i))**2 + (t(2, i) - old(2, i))**2 > rotated
         end do
         if (.not. any(turned)) return
         do i = 1, contact%surfaces%n
            if (turned(i)) old(:, i) = t(:, i)
         end do
      end associate
      associate (corner => contact%candidates%corner, prev => contact%surfaces%prev)
         do i = 1, size(corner, 2)
            if (any(turned(corner(:, i))) .or. any(turned(prev(corner(:, i))))) then
               call classify_corner(contact, i)
            end if
         end do
      end associate
   end subroutine turn_corners

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

   !> Choice: where faces of different friction meet in a corner, the largest holds.
   pure function friction_of(contact, first, second) result(friction)
      type(contact_type), intent(in) :: contact
      integer, intent(in) :: first(:)    !! edges at the one side
      integer, intent(in) :: second(:)   !! and at the other
      real(wp) :: friction

      friction = maxval(contact%friction(contact%surfaces%tag(first), &
         contact%surfaces%tag(second)))
   end function friction_of

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

end module lithofrac_contact_contact
