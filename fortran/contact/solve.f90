!> Contact of one step: pairs, impulses, and what they did to the energy.
!>
!> Forward increment (position level): the gap at the end of the step must not be negative, and
!> an impulse acts only where it is zero. Exact multipliers have no stiffness, so contact does
!> not lower the stable step.
module lithofrac_contact_solve
   use lithofrac_base_kinds, only: wp
   use lithofrac_contact_collect, only: collect_pairs, scales_type
   use lithofrac_contact_contact, only: contact_type, renew_list, statistics_type
   use lithofrac_contact_multipliers, only: solve_pairs
   use lithofrac_contact_pairs, only: pair_type
   use lithofrac_contact_surfaces, only: update_shape
   implicit none
   private

   public :: renew, solve_contact
   public :: solved, prescribed_collision, too_fast, lost

   ! Outcomes of a step.
   integer, parameter :: solved = 0
   integer, parameter :: prescribed_collision = 1  !! bodies that may not yield meet
   integer, parameter :: too_fast = 2              !! a pair may jump over its faces
   integer, parameter :: lost = 3                  !! a position is not finite

   integer, parameter :: usual_sweeps = 50
   integer, parameter :: many_sweeps = 200
   real(wp), parameter :: deep = 1.0e-4_wp         !! penetration that asks for many sweeps, over h
   real(wp), parameter :: accuracy = 2.5e-4_wp     !! of the largest relative velocity
   real(wp), parameter :: slop = 1.0e-6_wp         !! penetration left alone, over h
   real(wp), parameter :: fine = 1.0e-7_wp         !! gap that no sweep is worth, over h
   real(wp), parameter :: unfelt = 30.0_wp         !! impulse over what its nodes feel: a jam
   real(wp), parameter :: fading = 0.5_wp          !! of the first guess in a jam, by step
   real(wp), parameter :: longest_way = 0.05_wp    !! of a pair in a step, over h

contains

   !> A new list of candidates for the positions of now.
   subroutine renew(contact, code)
      type(contact_type), intent(inout) :: contact
      integer, intent(out) :: code

      code = solved
      call update_shape(contact%surfaces)
      if (all(abs(contact%surfaces%tangent) <= 1.5_wp)) then
         call renew_list(contact)
      else
         code = lost
      end if
   end subroutine renew

   !> Impulses of one step; `contact%motion` holds the velocities without contact, then with it.
   subroutine solve_contact(contact, dt, critical, threaded, code, node)
      type(contact_type), intent(inout) :: contact
      real(wp), intent(in) :: dt               !! [s]
      real(wp), intent(in) :: critical         !! largest stable step [s]
      logical, intent(in) :: threaded          !! the work is worth threads
      integer, intent(out) :: code
      integer, intent(out) :: node(2)          !! boundary nodes that failed

      integer :: group, most_sweeps
      logical :: collides
      real(wp) :: deepest, tolerance

      code = solved
      contact%work_before = 0.0_wp
      contact%work_after = 0.0_wp
      call collect_pairs(contact, scales_type(contact%surfaces%h, dt, critical, &
         sqrt(maxval(contact%slices(:contact%n_slices)%speed)), contact%tolerance*slop), &
         threaded, collides, node)
      if (collides) code = prescribed_collision
      call forget_impulses(contact)
      if (collides .or. contact%n_pairs == 0) return
      associate (h => contact%surfaces%h, groups => contact%groups(:contact%n_groups))
         deepest = maxval(contact%slices(:contact%n_slices)%deepest)
         tolerance = contact%tolerance &
            *max(accuracy*maxval(contact%slices(:contact%n_slices)%fastest), fine*h/dt)
         most_sweeps = ceiling(merge(many_sweeps, usual_sweeps, deepest > deep*h) &
            /sqrt(min(1.0_wp, contact%tolerance)))
         !$omp taskloop default(shared) grainsize(1) if(threaded)
         do group = 1, contact%n_groups
            call solve_group(contact, group, tolerance, most_sweeps, longest_way*h/dt)
         end do
         !$omp end taskloop
         group = findloc(groups%too_fast > 0, .true., dim=1)
         if (group > 0) then
            code = too_fast
            node = contact%pairs(groups(group)%too_fast)%node(:2)
            return
         end if
         call sum_work(contact)
         call count_step(contact%statistics, contact%n_pairs, maxval(groups%sweeps), &
            all(groups%converged), deepest/h)
      end associate
   end subroutine solve_contact

   !> Solve a group of islands and book what it does.
   pure subroutine solve_group(contact, number, tolerance, most_sweeps, limit)
      type(contact_type), intent(inout) :: contact
      integer, intent(in) :: number
      real(wp), intent(in) :: tolerance         !! change of a relative velocity [m/s]
      integer, intent(in) :: most_sweeps
      real(wp), intent(in) :: limit             !! of a relative velocity [m/s]

      real(wp) :: fastest, work(4)
      integer :: i

      associate (group => contact%groups(number))
         group%sweeps = 0
         group%converged = .true.
         group%too_fast = 0
         group%work = 0.0_wp
         if (group%last < group%first) return
         call solve_pairs(contact%pairs, contact%order, group%first, group%last, contact%motion, &
            tolerance, most_sweeps, contact%queue, group%sweeps, group%converged)
         do i = group%first, group%last
            call book_pair(contact, contact%pairs(contact%order(i)), work, fastest)
            if (contact%n_groups > 1) then
               contact%work(:, contact%order(i)) = work
            else
               group%work = group%work + work
            end if
            contact%loaded(i) = contact%pairs(contact%order(i))%candidate
            if (.not. fastest > limit .or. group%too_fast > 0) cycle
            group%too_fast = contact%order(i)
         end do
         do i = group%first, group%last
            call loosen_jam(contact, contact%pairs(contact%order(i)))
         end do
      end associate
   end subroutine solve_group

   !> Work of all pairs, always added in the same order; a single group has done so.
   pure subroutine sum_work(contact)
      type(contact_type), intent(inout) :: contact

      real(wp) :: work(4)
      integer :: i, pass, slice

      work = contact%groups(1)%work
      do pass = 1, merge(3, 0, contact%n_groups > 1)
         do slice = 1, contact%n_slices
            do i = contact%slices(slice)%first(pass), contact%slices(slice)%last(pass)
               work = work + contact%work(:, i)
            end do
         end do
      end do
      contact%work_before = work(:2)
      contact%work_after = work(3:)
      contact%n_loaded = contact%n_pairs
   end subroutine sum_work

   !> Clear the impulses of the step before.
   pure subroutine forget_impulses(contact)
      type(contact_type), intent(inout) :: contact

      integer :: i

      if (contact%n_loaded < 0) then
         contact%corner_impulse = 0.0_wp
         contact%edge_impulse = 0.0_wp
      end if
      do i = 1, contact%n_loaded
         associate (candidate => contact%loaded(i))
            if (candidate > 0) then
               contact%corner_impulse(:, candidate) = 0.0_wp
            else
               contact%edge_impulse(:, -candidate) = 0.0_wp
            end if
         end associate
      end do
      contact%n_loaded = 0
   end subroutine forget_impulses

   !> Remember an impulse for the next step; book its work and its share on the nodes.
   pure subroutine book_pair(contact, pair, work, fastest)
      type(contact_type), intent(inout) :: contact
      type(pair_type), intent(in) :: pair
      real(wp), intent(out) :: work(4)   !! normal, friction: half step before; then after [J]
      real(wp), intent(out) :: fastest   !! relative velocity that is left [m/s]

      real(wp) :: p(2), before(2), after(2), pressure(2)
      integer :: k

      after = 0.0_wp
      before = 0.0_wp
      do k = 1, pair%n_nodes
         associate (at => contact%record(pair%node(k)), v => contact%motion(pair%node(k))%v, &
               weight => pair%weight(k))
            after(1) = after(1) + weight*v(1)
            after(2) = after(2) + weight*v(2)
            before(1) = before(1) + weight*at%before(1)
            before(2) = before(2) + weight*at%before(2)
            at%impulse(1) = at%impulse(1) + weight*pair%impulse(1)
            at%impulse(2) = at%impulse(2) + weight*pair%impulse(2)
         end associate
      end do
      fastest = max(abs(after(1)), abs(after(2)))
      work = 0.0_wp
      p = pair%impulse
      if (.not. max(abs(p(1)), abs(p(2))) > 0.0_wp) return
      pressure = pressure_of(pair)
      work(1) = 0.5_wp*(pressure(1)*before(1) + pressure(2)*before(2))
      work(2) = 0.5_wp*((p(1) - pressure(1))*before(1) + (p(2) - pressure(2))*before(2))
      work(3) = 0.5_wp*(pressure(1)*after(1) + pressure(2)*after(2))
      work(4) = 0.5_wp*((p(1) - pressure(1))*after(1) + (p(2) - pressure(2))*after(2))
      associate (n => pair%normal(:, 1))
         p = [n(1)*p(1) + n(2)*p(2), n(1)*p(2) - n(2)*p(1)]
      end associate
      if (pair%candidate > 0) then
         contact%corner_impulse(:, pair%candidate) = p
      else
         contact%edge_impulse(:, -pair%candidate) = p
      end if
   end subroutine book_pair

   !> Let impulses that only hold each other fade from the first guess of the next step.
   !>
   !> Nodes of several parts at one place can wedge each other within their friction cones: such
   !> impulses cancel on every node, or act where motion is prescribed, so nothing determines
   !> them and they grow with rounding.
   pure subroutine loosen_jam(contact, pair)
      type(contact_type), intent(inout) :: contact
      type(pair_type), intent(in) :: pair

      real(wp) :: own, felt
      integer :: k

      own = pair%impulse(1)**2 + pair%impulse(2)**2
      if (.not. own > 0.0_wp) return
      felt = 0.0_wp
      do k = 1, pair%n_nodes
         associate (sum_of => contact%record(pair%node(k))%impulse, &
               yields => contact%motion(pair%node(k))%inverse_mass > 0.0_wp)
            felt = max(felt, merge(sum_of(1)**2, 0.0_wp, yields(1)) &
               + merge(sum_of(2)**2, 0.0_wp, yields(2)))
         end associate
      end do
      if (own <= unfelt**2*felt) return
      if (pair%candidate > 0) then
         contact%corner_impulse(:, pair%candidate) = fading &
            *contact%corner_impulse(:, pair%candidate)
      else
         contact%edge_impulse(:, -pair%candidate) = fading &
            *contact%edge_impulse(:, -pair%candidate)
      end if
   end subroutine loosen_jam

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
