!> Return mapping of one material point in principal stress space.
!>
!> The yield surface is a Mohr-Coulomb pyramid cut by three independent tension planes
!> (Klerck, Sellers & Owen 2004, eqs 6, 8, 9, 17-20 and Fig. 2). Backward Euler: c, phi and psi
!> belong to the new effective plastic strain e, so a return solves
!>    F(e) = e - e_old - g(e) = 0,   g = sqrt(2/3 dep : dep)   (eq. 7),
!> where g comes from the linear problem at fixed strength. F is not positive at e_old; the
!> tables are walked segment by segment up to the first sign change, so that the smallest e is
!> taken where there are several. Where g jumps across zero, two sets share their stress there
!> and a mixture of both flows is the answer.
!>
!> This module knows nothing of axes, elements, meshes or time.
module lithofrac_material_return_map
   use lithofrac_base_kinds, only: wp
   use lithofrac_base_status, only: no_return_map, ok
   use lithofrac_material_active_sets, only: apex, edge_of, main_plane, &
      member_high, member_low, n_members, no_planes, plane_bit
   use lithofrac_material_fixed_strength, only: flow_type, free_choice, return_to_any, &
      return_to_set, trial_type
   use lithofrac_material_flow_split, only: least_flow_at_apex, least_flow_of_equal_maxima, &
      least_flow_of_equal_minima
   use lithofrac_material_mohr_coulomb, only: main_plane_yield, mobilise, mobilised_type
   use lithofrac_material_rock, only: rock_type
   use lithofrac_material_tension_planes, only: softened_strength
   implicit none
   private

   public :: return_to_surface, apex_bit, mixture_bit

   integer, parameter :: apex_bit = 9      !! all six Mohr-Coulomb planes
   integer, parameter :: mixture_bit = 10  !! two sets that share their stress

   real(wp), parameter :: two_thirds = 2.0_wp/3.0_wp
   real(wp), parameter :: working_tolerance = 0.5_wp  !! of the yield tolerance
   real(wp), parameter :: tie_tolerance = 1.0e-2_wp   !! of the yield tolerance
   integer, parameter :: max_walk = 2000
   real(wp), parameter :: max_reach = 8.0_wp
   integer, parameter :: max_bracket = 200

   !> One point of the function F.
   type :: sample_type
      real(wp) :: e = 0.0_wp  !! effective plastic strain [-]
      real(wp) :: f = 0.0_wp  !! e - e_old - g [-]
      type(flow_type) :: flow
   end type sample_type

contains

   !> Bring a trial stress back to the yield surface.
   !>
   !> On `code == no_return_map` the trial stress is handed back and nothing has flowed.
   pure subroutine return_to_surface(rock, h, trial, ft, ep_eff, dep, dep_compressive, active, code)
      type(rock_type), intent(in) :: rock
      real(wp), intent(in) :: h                   !! softening modulus, not positive [Pa]
      real(wp), intent(in) :: trial(3)            !! principal trial stresses, any order [Pa]
      real(wp), intent(in) :: ft(3)               !! tensile strengths, axis i of `trial` [Pa]
      real(wp), intent(inout) :: ep_eff           !! effective plastic strain [-], eq. 7
      real(wp), intent(out) :: dep(3)             !! inelastic strain increments [-]
      real(wp), intent(out) :: dep_compressive(3) !! their Mohr-Coulomb part [-]
      integer, intent(out) :: active              !! planes with flow, see `active_mask`
      integer, intent(out) :: code                !! `ok` or `no_return_map`

      type(trial_type) :: sorted
      type(sample_type) :: best
      integer :: order(3)
      logical :: found, mixed
      real(wp) :: rounding

      dep = 0.0_wp
      dep_compressive = 0.0_wp
      active = 0
      code = ok
      order = descending(trial)
      sorted%t = trial(order)
      sorted%ft = ft(order)
      sorted%h = h
      sorted%g2 = 2.0_wp*rock%shear
      sorted%lame = rock%lame
      rounding = 8.0_wp*epsilon(1.0_wp)*max(abs(sorted%t(1)), abs(sorted%t(3)))
      sorted%tolerance = max(working_tolerance*rock%yield_tolerance, rounding)
      sorted%tie = max(tie_tolerance*rock%yield_tolerance, rounding)
      sorted%noise = 2.0_wp*epsilon(1.0_wp)*(ep_eff &
         + (abs(sorted%t(1)) + abs(sorted%t(3)) + rock%strength_scale)/sorted%g2)
      sorted%compression = rock%compression
      sorted%total = rock%total_hardening
      best%flow = likely_flow(rock, sorted, ep_eff)
      if (best%flow%group == no_planes .and. best%flow%tension == 0) return

      call search(rock, sorted, ep_eff, free_choice, best, mixed, found)
      if (rock%explicit_coupling) call search_explicit(rock, sorted, ep_eff, best, mixed, found)
      if (.not. found) then
         code = no_return_map
         return
      end if
      ep_eff = best%e
      dep(order) = best%flow%d
      dep_compressive(order) = best%flow%x
      active = active_mask(best%flow, order, mixed)
   end subroutine return_to_surface

   !> The planes that the trial stress lies beyond: most often those that it returns to.
   pure function likely_flow(rock, trial, e_old) result(flow)
      type(rock_type), intent(in) :: rock
      type(trial_type), intent(in) :: trial
      real(wp), intent(in) :: e_old
      type(flow_type) :: flow

      type(mobilised_type) :: now
      integer :: i

      do i = 1, 3
         if (trial%t(i) - trial%ft(i) <= rock%yield_tolerance) cycle
         flow%tension = ibset(flow%tension, i - 1)
      end do
      flow%group = no_planes
      if (.not. rock%compression) return
      call mobilise(rock, e_old, now)
      ! Not "greater than": a stress that is not a number is not elastic.
      if (.not. main_plane_yield(now, trial%t) <= rock%yield_tolerance) flow%group = main_plane
   end function likely_flow

   !> Smallest root of F, walking the segments of the tables from knot to knot.
   !> Where g grows, steps of -F cannot pass the first root; they double inside a segment.
   pure subroutine search(rock, trial, e_old, prescribed, best, mixed, found)
      type(rock_type), intent(in) :: rock
      type(trial_type), intent(in) :: trial
      real(wp), intent(in) :: e_old
      integer, intent(in) :: prescribed        !! tension planes, or `free_choice`
      type(sample_type), intent(inout) :: best !! in: likely set; out: the root
      logical, intent(out) :: mixed            !! a mixture of two sets
      logical, intent(out) :: found

      integer :: trip
      type(sample_type) :: low, high
      real(wp) :: knot, next_knot, reach

      mixed = .false.
      low%flow = best%flow
      low%e = e_old
      call sample(rock, trial, e_old, prescribed, low, knot, found)
      if (.not. found) return
      best = low
      if (converged(trial, low, e_old)) return
      high = low
      reach = 1.0_wp
      do trip = 1, max_walk
         high%e = min(low%e - reach*low%f, knot)
         if (.not. high%e > low%e) high%e = low%e + spacing(low%e)
         call sample(rock, trial, e_old, prescribed, high, next_knot, found)
         if (.not. found) return
         if (high%f >= 0.0_wp .or. converged(trial, high, e_old)) exit
         low = high
         reach = merge(1.0_wp, min(2.0_wp*reach, max_reach), next_knot > knot)
         knot = next_knot
      end do
      found = trip <= max_walk
      if (.not. found) return
      call close_in(rock, trial, e_old, prescribed, low, high, best, mixed, found)
   end subroutine search

   !> Root of F between `low` (F < 0) and `high` (F >= 0): Illinois steps, halved now and then.
   pure subroutine close_in(rock, trial, e_old, prescribed, low, high, best, mixed, found)
      type(rock_type), intent(in) :: rock
      type(trial_type), intent(in) :: trial
      real(wp), intent(in) :: e_old
      integer, intent(in) :: prescribed
      type(sample_type), intent(inout) :: low, high
      type(sample_type), intent(inout) :: best
      logical, intent(out) :: mixed
      logical, intent(out) :: found

      integer :: side, trip
      real(wp) :: f_high, f_low, knot, width

      mixed = .false.
      found = .true.
      best = high
      if (converged(trial, high, e_old)) return
      f_low = low%f
      f_high = high%f
      side = 0
      width = high%e - low%e
      do trip = 1, max_bracket
         if (high%e - low%e <= 2.0_wp*spacing(high%e)) exit
         best%e = (low%e*f_high - high%e*f_low)/(f_high - f_low)
         if (mod(trip, 4) == 0 .and. high%e - low%e > 0.25_wp*width) then
            best%e = 0.5_wp*(low%e + high%e)
         end if
         if (mod(trip, 4) == 0) width = high%e - low%e
         if (.not. (best%e > low%e .and. best%e < high%e)) best%e = 0.5_wp*(low%e + high%e)
         call sample(rock, trial, e_old, prescribed, best, knot, found)
         if (.not. found) return
         if (converged(trial, best, e_old)) return
         if (best%f < 0.0_wp) then
            low = best
            f_low = best%f
            if (side == -1) f_high = 0.5_wp*f_high
            side = -1
         else
            high = best
            f_high = best%f
            if (side == 1) f_low = 0.5_wp*f_low
            side = 1
         end if
      end do
      call mix(rock, trial, e_old, prescribed, low, high, best, found)
      mixed = found
   end subroutine close_in

   !> F at one effective plastic strain, with the least compressive split of the flow.
   pure subroutine sample(rock, trial, e_old, prescribed, point, knot, found)
      type(rock_type), intent(in) :: rock
      type(trial_type), intent(in) :: trial
      real(wp), intent(in) :: e_old
      integer, intent(in) :: prescribed
      type(sample_type), intent(inout) :: point  !! in: `e` and a likely set
      real(wp), intent(out) :: knot              !! where the next segment of the tables starts
      logical, intent(out) :: found

      type(mobilised_type) :: now

      knot = huge(1.0_wp)
      if (rock%compression) then
         call mobilise(rock, point%e, now)
         knot = now%knot
      end if
      call return_to_any(trial, now, prescribed, point%flow, found)
      if (.not. found) return
      if (prescribed == free_choice .and. point%flow%group /= no_planes) then
         call take_least_flow(trial, now, point%flow)
      end if
      point%f = point%e - e_old - increment(trial, point%flow)
   end subroutine sample

   !> Effective plastic strain increment of a flow (eq. 7).
   pure function increment(trial, flow) result(g)
      type(trial_type), intent(in) :: trial
      type(flow_type), intent(in) :: flow
      real(wp) :: g

      if (trial%total) then
         g = sqrt(two_thirds*sum(flow%d**2))
      else
         g = sqrt(two_thirds*sum(flow%x**2))
      end if
   end function increment

   !> True if F vanishes to rounding.
   pure function converged(trial, point, e_old)
      type(trial_type), intent(in) :: trial
      type(sample_type), intent(in) :: point
      real(wp), intent(in) :: e_old
      logical :: converged

      converged = abs(point%f) <= 1.0e-13_wp*(point%e - e_old) + trial%noise
   end function converged

   !> Where more planes meet than the set holds, take the smallest Mohr-Coulomb flow.
   pure subroutine take_least_flow(trial, now, flow)
      type(trial_type), intent(in) :: trial
      type(mobilised_type), intent(in) :: now
      type(flow_type), intent(inout) :: flow

      integer :: group, high, low, middle
      logical :: open(3), equal_maxima, equal_minima
      real(wp) :: rounding, x(3)

      open = flow%s - softened_strength(trial%ft, trial%h, flow%d) >= -trial%tie
      if (.not. any(open)) return
      high = maxloc(flow%s, 1)
      low = minloc(flow%s, 1)
      if (high == low) low = modulo(high, 3) + 1
      middle = 6 - high - low
      equal_maxima = flow%s(high) - flow%s(middle) <= trial%tie
      equal_minima = flow%s(middle) - flow%s(low) <= trial%tie
      if (equal_maxima .and. equal_minima) then
         group = apex
         call least_flow_at_apex(now, flow%d, open, x)
      else if (equal_maxima .and. count(open) > 1) then
         group = edge_of(high, middle, low, larger=.false.)
         call least_flow_of_equal_maxima(now, flow%d, open, high, middle, low, x)
      else if (equal_minima .and. count(open) > 1) then
         group = edge_of(middle, low, high, larger=.true.)
         call least_flow_of_equal_minima(now, flow%d, open, high, middle, low, x)
      else
         return
      end if
      if (sum(x**2) >= sum(flow%x**2)) return
      ! Planes that only nearly meet do not leave the split open.
      rounding = 1.0e-13_wp*maxval(abs(flow%d))
      if (any(flow%d - x < -rounding) .or. any(flow%d - x > rounding .and. .not. open)) return
      if (equal_maxima .and. .not. equal_minima) then
         if (min(x(high), x(middle)) < 0.0_wp) return
      end if
      flow%x = x
      flow%group = merge(group, no_planes, any(x < 0.0_wp .or. x > 0.0_wp))
   end subroutine take_least_flow

   !> Two sets that are both right at the strain where F jumps: mix their flows.
   pure subroutine mix(rock, trial, e_old, prescribed, low, high, best, found)
      type(rock_type), intent(in) :: rock
      type(trial_type), intent(in) :: trial
      real(wp), intent(in) :: e_old
      integer, intent(in) :: prescribed
      type(sample_type), intent(in) :: low, high
      type(sample_type), intent(inout) :: best
      logical, intent(out) :: found

      type(mobilised_type) :: now
      real(wp) :: a, b, c, change(3), share

      best = high
      change = low%flow%x - high%flow%x
      a = sum(change**2)
      b = sum(change*high%flow%x)
      c = sum(high%flow%x**2) - 1.5_wp*(high%e - e_old)**2
      found = .not. trial%total .and. a > 0.0_wp .and. b*b - a*c >= 0.0_wp
      if (.not. found) return
      share = min(1.0_wp, max(0.0_wp, (sqrt(b*b - a*c) - b)/a))
      best%flow%x = high%flow%x + share*change
      best%flow%d = high%flow%d + share*(low%flow%d - high%flow%d)
      best%flow%s = trial%t - trial%g2*best%flow%d - trial%lame*sum(best%flow%d)
      best%flow%tension = ior(low%flow%tension, high%flow%tension)
      best%flow%group = merge(low%flow%group, high%flow%group, high%flow%group == no_planes)
      call mobilise(rock, best%e, now)
      found = main_plane_yield(now, best%flow%s) <= rock%yield_tolerance
      if (prescribed /= free_choice) return
      found = found .and. all(best%flow%s - softened_strength(trial%ft, trial%h, best%flow%d) &
         <= rock%yield_tolerance)
   end subroutine mix

   !> Explicit coupling (section 2.4): planes that are not active are checked with their old
   !> strength. Every choice of tension planes is tried; the smallest strain wins.
   pure subroutine search_explicit(rock, trial, e_old, best, mixed, found)
      type(rock_type), intent(in) :: rock
      type(trial_type), intent(in) :: trial
      real(wp), intent(in) :: e_old
      type(sample_type), intent(inout) :: best  !! in: the implicit return, which is admissible
      logical, intent(inout) :: mixed
      logical, intent(inout) :: found

      type(sample_type) :: other
      integer :: i, tension
      logical :: other_found, other_mixed
      real(wp) :: opening

      do tension = 0, 7
         other%flow%tension = tension
         other%flow%group = no_planes
         call search(rock, trial, e_old, tension, other, other_mixed, other_found)
         if (.not. other_found) cycle
         do i = 1, 3
            opening = other%flow%d(i) - other%flow%x(i)
            if (btest(tension, i - 1)) then
               if (opening < -0.1_wp*trial%tolerance/trial%g2) other_found = .false.
            else if (other%flow%s(i) - trial%ft(i) > trial%tolerance) then
               other_found = .false.
            end if
         end do
         if (.not. other_found) cycle
         if (found .and. other%e >= best%e) cycle
         best = other
         mixed = other_mixed
         found = .true.
      end do
   end subroutine search_explicit

   !> Planes with flow. Bits 0 to 2: tension planes of axes 1 to 3; bits 3 to 8: planes (i, j)
   !> = (1,2), (1,3), (2,1), (2,3), (3,1), (3,2); bit 9: apex; bit 10: mixture of two sets.
   pure function active_mask(flow, order, mixed) result(mask)
      type(flow_type), intent(in) :: flow
      integer, intent(in) :: order(3)  !! axis of each sorted stress
      logical, intent(in) :: mixed
      integer :: mask

      integer :: high, i, low, m
      logical :: shared_high

      mask = 0
      do i = 1, 3
         if (flow%d(i) > flow%x(i)) mask = ibset(mask, order(i) - 1)
      end do
      shared_high = member_high(1, flow%group) == member_high(2, flow%group)
      do m = 1, n_members(flow%group)
         high = member_high(m, flow%group)
         low = member_low(m, flow%group)
         if (n_members(flow%group) == 2 .and. .not. abs(flow%x(merge(low, high, shared_high))) &
            > 0.0_wp) cycle
         mask = ibset(mask, plane_bit(order(high), order(low)))
      end do
      if (flow%group == apex) mask = ibset(mask, apex_bit)
      if (mixed) mask = ibset(mask, mixture_bit)
   end function active_mask

   !> Axes of the stresses, largest first; equal ones keep their order.
   pure function descending(t) result(order)
      real(wp), intent(in) :: t(3)
      integer :: order(3)

      order = [1, 2, 3]
      if (t(order(1)) < t(order(2))) order(1:2) = order([2, 1])
      if (t(order(2)) < t(order(3))) order(2:3) = order([3, 2])
      if (t(order(1)) < t(order(2))) order(1:2) = order([2, 1])
   end function descending

end module lithofrac_material_return_map
