!> Returns at a given effective plastic strain: the linear half of the return mapping.
!>
!> With c, phi and psi fixed, each active set is a small linear problem in the plastic
!> multipliers (Koiter's rule, eq. 9), apart from the kinks of eqs 16-18: a tension plane keeps
!> its strength while its total inelastic strain is negative, softens, and stays at zero.
!> Principal stresses are sorted, the largest trial stress first.
!> This module knows nothing of tables: `lithofrac_material_return_map` finds the strain.
module lithofrac_material_fixed_strength
   use lithofrac_base_kinds, only: wp
   use lithofrac_material_active_sets, only: apex, feasible, member_high, member_low, &
      n_groups, n_members
   use lithofrac_material_mohr_coulomb, only: main_plane_yield, mobilised_type
   use lithofrac_material_tension_planes, only: softened_strength
   implicit none
   private

   public :: trial_type, flow_type, return_to_set, return_to_any
   public :: free_choice

   integer, parameter :: free_choice = -1  !! no group of tension planes is prescribed
   integer, parameter :: intact = 0, softening = 1, exhausted = 2
   integer, parameter :: max_kinks = 12    !! changes of stage before a set is given up

   !> What stays the same during one return.
   type :: trial_type
      real(wp) :: t(3)        !! trial stresses, largest first [Pa]
      real(wp) :: ft(3)       !! tensile strengths before the step, same order [Pa]
      real(wp) :: h           !! softening modulus, not positive [Pa]
      real(wp) :: g2          !! twice the shear modulus [Pa]
      real(wp) :: lame        !! Lame's first constant [Pa]
      real(wp) :: tolerance   !! on yield functions [Pa]
      real(wp) :: tie         !! stresses closer than this are equal [Pa]
      real(wp) :: noise       !! rounding of a strain increment [-]
      logical :: compression  !! Mohr-Coulomb planes exist
      logical :: total        !! all inelastic strain counts as effective plastic strain
   end type trial_type

   !> One return.
   type :: flow_type
      real(wp) :: s(3) = 0.0_wp  !! stresses [Pa]
      real(wp) :: d(3) = 0.0_wp  !! inelastic strain increments [-]
      real(wp) :: x(3) = 0.0_wp  !! the part of `d` from Mohr-Coulomb planes [-]
      integer :: tension = 0     !! active tension planes, bits 0 to 2
      integer :: group = 1       !! active Mohr-Coulomb planes
   end type flow_type

contains

   !> First consistent return, starting with the set that `flow` names.
   pure subroutine return_to_any(trial, now, prescribed, flow, found)
      type(trial_type), intent(in) :: trial
      type(mobilised_type), intent(in) :: now
      integer, intent(in) :: prescribed        !! tension planes, or `free_choice`
      type(flow_type), intent(inout) :: flow   !! in: likely set; out: the return
      logical, intent(out) :: found

      integer :: group, likely_group, likely_tension, tension

      likely_tension = flow%tension
      likely_group = flow%group
      if (feasible(likely_tension, likely_group)) then
         call return_to_set(trial, now, prescribed, flow, found)
         if (found) return
      end if
      do group = 1, merge(n_groups, 1, trial%compression)
         do tension = 0, 7
            if (prescribed /= free_choice .and. prescribed /= tension) cycle
            if (group == likely_group .and. tension == likely_tension) cycle
            if (.not. feasible(tension, group)) cycle
            flow%tension = tension
            flow%group = group
            call return_to_set(trial, now, prescribed, flow, found)
            if (found) return
         end do
      end do
   end subroutine return_to_any

   !> Return to the set that `flow` names, if that is consistent.
   !> With prescribed tension planes these are left to the caller to judge.
   pure subroutine return_to_set(trial, now, prescribed, flow, found)
      type(trial_type), intent(in) :: trial
      type(mobilised_type), intent(in) :: now
      integer, intent(in) :: prescribed
      type(flow_type), intent(inout) :: flow
      logical, intent(out) :: found

      integer :: i
      real(wp) :: opening(3)

      if (flow%group == apex) then
         call return_to_apex(trial, now, flow, found)
      else
         call solve_linear(trial, now, flow, opening, found)
      end if
      if (.not. found) return
      found = .false.
      if (flow%group /= apex) then
         if (prescribed == free_choice) then
            do i = 1, 3
               if (opening(i) < -0.1_wp*trial%tolerance/trial%g2) return
               if (opening(i) < 0.0_wp) flow%d(i) = flow%x(i)
            end do
         end if
         flow%s = trial%t - trial%g2*flow%d - trial%lame*sum(flow%d)
      end if
      if (trial%compression) then
         if (main_plane_yield(now, flow%s) > trial%tolerance) return
      end if
      if (prescribed == free_choice) then
         if (any(flow%s - softened_strength(trial%ft, trial%h, flow%d) > trial%tolerance)) return
      end if
      found = .true.
   end subroutine return_to_set

   !> Apex of the pyramid: the stress is known, the flow must lie in the cone of the six planes.
   !>
   !> The cone is the hull of all orders of (a, 0, -b), so d lies in it if and only if it is
   !> majorised by that vector times tr d/sin psi. Choice: with psi = 0 the limit of vanishing
   !> dilation is taken, in which any opening without volume loss is possible.
   pure subroutine return_to_apex(trial, now, flow, found)
      type(trial_type), intent(in) :: trial
      type(mobilised_type), intent(in) :: now
      type(flow_type), intent(inout) :: flow
      logical, intent(out) :: found

      real(wp) :: excess(3), slack, volume

      found = .false.
      if (now%sin_phi <= 0.0_wp) return
      flow%s = now%k/now%sin_phi
      excess = trial%t - flow%s
      volume = sum(excess)/(3.0_wp*trial%lame + trial%g2)
      flow%d = (excess - trial%lame*volume)/trial%g2
      flow%x = flow%d
      slack = 0.1_wp*trial%tolerance/trial%g2
      found = now%sin_psi*maxval(flow%d) <= now%a_flow*volume + slack .and. &
         -now%sin_psi*minval(flow%d) <= now%b_flow*volume + slack
   end subroutine return_to_apex

   !> Solve the linear problem of one set, with the stages of its tension planes.
   !> Stages follow from the strain of the last trial; should they never settle, all are tried.
   pure subroutine solve_linear(trial, now, flow, opening, found)
      type(trial_type), intent(in) :: trial
      type(mobilised_type), intent(in) :: now
      type(flow_type), intent(inout) :: flow
      real(wp), intent(out) :: opening(3)  !! multipliers of the tension planes [-]
      logical, intent(out) :: found

      integer :: stage(3), trip
      logical :: flows, settled

      stage = merge(softening, exhausted, trial%ft > 0.0_wp)
      do trip = 1, max_kinks + 27
         if (trip > max_kinks) then
            stage = modulo((trip - max_kinks - 1)/[1, 3, 9], 3)
            if (any(stage /= softening .and. .not. open_planes(flow%tension))) cycle
         end if
         call solve_stage(trial, now, stage, flow, flows, found)
         if (.not. found) then
            if (any(open_planes(flow%tension))) cycle
            return
         end if
         call compare_stages(trial, flow, trip <= max_kinks, stage, settled)
         if (settled) exit
      end do
      found = settled .and. flows
      opening = flow%d - flow%x
   end subroutine solve_linear

   pure function open_planes(tension) result(open)
      integer, intent(in) :: tension
      logical :: open(3)

      open = [btest(tension, 0), btest(tension, 1), btest(tension, 2)]
   end function open_planes

   !> Stages that the strains ask for, and whether these were the ones assumed.
   pure subroutine compare_stages(trial, flow, follow, stage, settled)
      type(trial_type), intent(in) :: trial
      type(flow_type), intent(in) :: flow
      logical, intent(in) :: follow          !! let `stage` change
      integer, intent(inout) :: stage(3)
      logical, intent(out) :: settled

      integer :: asked, i

      settled = .true.
      do i = 1, 3
         if (.not. btest(flow%tension, i - 1) .or. .not. trial%ft(i) > 0.0_wp) cycle
         asked = softening
         if (flow%d(i) < 0.0_wp) asked = intact
         if (trial%ft(i) + trial%h*flow%d(i) < 0.0_wp) asked = exhausted
         settled = settled .and. asked == stage(i)
         if (follow) stage(i) = asked
      end do
   end subroutine compare_stages

   !> The linear problem with the stage of every tension plane given.
   !>
   !> With tau = lame tr(d), an active tension plane gives d_i = (y_i - tau)/h_i, any other
   !> axis d_i = (flow of the Mohr-Coulomb multipliers)_i. Both make
   !> s_i = alpha_i - beta_i tau - own_i x_i, and tau is linear in the multipliers.
   pure subroutine solve_stage(trial, now, stage, flow, flows, found)
      type(trial_type), intent(in) :: trial
      type(mobilised_type), intent(in) :: now
      integer, intent(in) :: stage(3)
      type(flow_type), intent(inout) :: flow
      logical, intent(out) :: flows        !! no Mohr-Coulomb multiplier is negative
      logical, intent(out) :: found        !! the problem has one answer

      integer :: high, i, low, m, members
      real(wp) :: alpha(3), beta(3), direction(3, 2), fall(3, 2), inverse(3)
      real(wp) :: lambda(2), matrix(2, 2), over(2), own(3), strength, tau, theta, weight, y(3)

      members = n_members(flow%group)
      alpha = trial%t
      beta = 1.0_wp
      own = trial%g2
      inverse = 0.0_wp
      y = 0.0_wp
      do i = 1, 3
         if (.not. btest(flow%tension, i - 1)) cycle
         strength = merge(0.0_wp, trial%ft(i), stage(i) == exhausted)
         beta(i) = merge(trial%h, 0.0_wp, stage(i) == softening)
         inverse(i) = 1.0_wp/(trial%g2 + beta(i))
         beta(i) = beta(i)*inverse(i)
         y(i) = trial%t(i) - strength
         alpha(i) = strength + beta(i)*y(i)
         own(i) = 0.0_wp
      end do
      weight = trial%lame/(1.0_wp + trial%lame*sum(inverse))
      tau = weight*sum(y*inverse)
      alpha = alpha - beta*tau

      lambda = 0.0_wp
      flow%x = 0.0_wp
      flows = .true.
      found = .false.
      if (members > 0) then
         direction = 0.0_wp
         do m = 1, members
            direction(member_high(m, flow%group), m) = now%a_flow
            direction(member_low(m, flow%group), m) = -now%b_flow
            theta = weight*sum(direction(:, m), mask=own > 0.0_wp)
            fall(:, m) = beta*theta + own*direction(:, m)
         end do
         do m = 1, members
            high = member_high(m, flow%group)
            low = member_low(m, flow%group)
            over(m) = now%a*alpha(high) - now%b*alpha(low) - now%k
            matrix(m, :members) = now%a*fall(high, :members) - now%b*fall(low, :members)
         end do
         if (members == 1) then
            if (.not. abs(matrix(1, 1)) > 0.0_wp) return
            lambda(1) = over(1)/matrix(1, 1)
         else
            call eliminate(matrix, over, lambda, found)
            if (.not. found) return
            found = .false.
         end if
         flows = all(lambda >= -0.1_wp*trial%tolerance/trial%g2)
         if (flows) lambda = max(lambda, 0.0_wp)
         do m = 1, members
            flow%x = flow%x + lambda(m)*direction(:, m)
            tau = tau + lambda(m)*weight*sum(direction(:, m), mask=own > 0.0_wp)
         end do
      end if
      do i = 1, 3
         flow%d(i) = flow%x(i)
         if (btest(flow%tension, i - 1)) flow%d(i) = (y(i) - tau)*inverse(i)
      end do
      found = .true.
   end subroutine solve_stage

   !> Two linear equations by elimination with row pivoting. Cramer's rule would lose the digits
   !> that edges need at friction angles near 90 degrees.
   pure subroutine eliminate(matrix, right, x, found)
      real(wp), intent(in) :: matrix(2, 2)
      real(wp), intent(in) :: right(2)
      real(wp), intent(out) :: x(2)
      logical, intent(out) :: found  !! the matrix is regular

      integer :: other, pivot
      real(wp) :: factor, rest

      x = 0.0_wp
      pivot = merge(1, 2, abs(matrix(1, 1)) >= abs(matrix(2, 1)))
      other = 3 - pivot
      found = abs(matrix(pivot, 1)) > 0.0_wp
      if (.not. found) return
      factor = matrix(other, 1)/matrix(pivot, 1)
      rest = matrix(other, 2) - factor*matrix(pivot, 2)
      found = abs(rest) > 1.0e-14_wp*abs(matrix(other, 2))
      if (.not. found) return
      x(2) = (right(other) - factor*right(pivot))/rest
      x(1) = (right(pivot) - matrix(pivot, 2)*x(2))/matrix(pivot, 1)
   end subroutine eliminate

end module lithofrac_material_fixed_strength
