!> The most frequent returns, to the compressive pyramid alone, at full speed.
!>
!> The plane of the extreme stresses by Newton's method (eqs 6-9 and 19 of Klerck, Sellers &
!> Owen 2004), the two edges next to it by the secant method. Both solve for the effective
!> plastic strain inside one segment of the tables. Whatever else a step needs (tension planes,
!> another segment, other edges) is left to `lithofrac_material_return_map`.
module lithofrac_material_pyramid_return
   use lithofrac_base_kinds, only: wp
   use lithofrac_material_fixed_strength, only: flow_type, trial_type
   use lithofrac_material_mohr_coulomb, only: advance, mobilised_type
   use lithofrac_material_rock, only: rock_type
   use lithofrac_material_tension_planes, only: softened_strength
   implicit none
   private

   public :: return_to_pyramid

   real(wp), parameter :: third = 1.0_wp/3.0_wp
   integer, parameter :: main_plane = 2, edge_of_maxima = 3, edge_of_minima = 4  !! active sets
   integer, parameter :: max_trips = 12

contains

   !> Return to the plane (1, 3), or to its edge with (2, 3) or (1, 2), if that is consistent.
   !> If not, `flow` still names the set that looked most likely.
   pure subroutine return_to_pyramid(rock, trial, e_old, start, e, flow, found)
      type(rock_type), intent(in) :: rock
      type(trial_type), intent(in) :: trial
      real(wp), intent(in) :: e_old              !! effective plastic strain before the step [-]
      type(mobilised_type), intent(in) :: start  !! strength at `e_old`
      real(wp), intent(out) :: e                 !! effective plastic strain [-]
      type(flow_type), intent(inout) :: flow
      logical, intent(out) :: found

      e = e_old
      flow%tension = 0
      flow%group = main_plane
      call return_to_main_plane(rock, trial, e_old, start, e, flow, found)
      if (.not. found) return
      if (flow%s(2) > flow%s(1)) flow%group = edge_of_maxima
      if (flow%s(2) < flow%s(3)) flow%group = edge_of_minima
      if (flow%group /= main_plane) call return_to_edge(rock, trial, e_old, start, e, flow, found)
      found = found .and. flow%s(1) >= max(flow%s(2), flow%s(3)) - trial%tie &
         .and. all(flow%s <= softened_strength(trial%ft, trial%h, flow%d))
   end subroutine return_to_pyramid

   !> Newton's method on the plane of the extreme stresses.
   pure subroutine return_to_main_plane(rock, trial, e_old, start, e, flow, found)
      type(rock_type), intent(in) :: rock
      type(trial_type), intent(in) :: trial
      real(wp), intent(in) :: e_old
      type(mobilised_type), intent(in) :: start
      real(wp), intent(inout) :: e
      type(flow_type), intent(inout) :: flow
      logical, intent(out) :: found

      type(mobilised_type) :: now
      integer :: trip
      real(wp) :: f_slope, g, g_slope, give, k_slope, lambda, norm, product, stiff, stiff_slope

      found = .false.
      now = start
      stiff = 0.5_wp*trial%g2 + trial%lame
      do trip = 1, max_trips
         product = now%sin_phi*now%sin_psi
         norm = sqrt(third*(1.0_wp + now%sin_psi**2))
         give = 1.0_wp/(0.5_wp*trial%g2 + stiff*product)
         lambda = (now%a*trial%t(1) - now%b*trial%t(3) - now%k)*give
         g = norm*lambda
         found = abs(e - e_old - g) <= 1.0e-13_wp*g + trial%noise
         if (found) exit
         k_slope = now%c_slope*now%cos_phi - now%c*now%sin_phi*now%phi_slope
         f_slope = 0.5_wp*(trial%t(1) + trial%t(3))*now%cos_phi*now%phi_slope - k_slope
         stiff_slope = stiff*(now%cos_phi*now%phi_slope*now%sin_psi &
            + now%sin_phi*now%cos_psi*now%psi_slope)
         g_slope = norm*give*(f_slope - lambda*stiff_slope) &
            + third*lambda*now%sin_psi*now%cos_psi*now%psi_slope/norm
         if (.not. g_slope < 1.0_wp) return
         e = e + (e_old + g - e)/(1.0_wp - g_slope)
         if (.not. (e >= e_old .and. e <= start%knot)) return
         call advance(rock, start, e_old, e, now)
      end do
      found = found .and. lambda >= 0.0_wp
      if (.not. found) return
      flow%x = [now%a_flow*lambda, 0.0_wp, -now%b_flow*lambda]
      flow%d = flow%x
      flow%s = trial%t - trial%g2*flow%d - trial%lame*sum(flow%d)
   end subroutine return_to_main_plane

   !> Secant method on the edge that `flow` names, from the strain of the main plane.
   pure subroutine return_to_edge(rock, trial, e_old, start, e, flow, found)
      type(rock_type), intent(in) :: rock
      type(trial_type), intent(in) :: trial
      real(wp), intent(in) :: e_old
      type(mobilised_type), intent(in) :: start
      real(wp), intent(inout) :: e
      type(flow_type), intent(inout) :: flow
      logical, intent(out) :: found

      type(mobilised_type) :: now
      integer :: trip
      real(wp) :: e_before, g, miss, miss_before

      found = .false.
      e_before = e_old
      call flow_on_edge(trial, start, flow, g)
      miss_before = -g
      do trip = 1, max_trips
         if (.not. (e > e_old .and. e <= start%knot)) return
         call advance(rock, start, e_old, e, now)
         call flow_on_edge(trial, now, flow, g)
         miss = e - e_old - g
         found = abs(miss) <= 1.0e-13_wp*g + trial%noise
         if (found) exit
         if (.not. abs(miss - miss_before) > 0.0_wp) return
         g = e - miss*(e - e_before)/(miss - miss_before)
         e_before = e
         miss_before = miss
         e = g
      end do
      if (.not. found) return
      flow%d = flow%x
      flow%s = trial%t - trial%g2*flow%d - trial%lame*sum(flow%d)
      if (flow%group == edge_of_maxima) found = min(flow%x(1), flow%x(2)) >= 0.0_wp
      if (flow%group == edge_of_minima) found = max(flow%x(2), flow%x(3)) <= 0.0_wp
   end subroutine return_to_edge

   !> Flow to an edge at fixed strength. By symmetry the sum and the difference of the two
   !> multipliers decouple; the difference closes the gap between the two equal stresses.
   pure subroutine flow_on_edge(trial, now, flow, g)
      type(trial_type), intent(in) :: trial
      type(mobilised_type), intent(in) :: now
      type(flow_type), intent(inout) :: flow
      real(wp), intent(out) :: g  !! effective plastic strain increment [-]

      real(wp) :: both, gap, one, product, two

      product = (0.5_wp*trial%g2 + 2.0_wp*trial%lame)*now%sin_phi*now%sin_psi + 0.5_wp*trial%g2
      if (flow%group == edge_of_maxima) then
         both = (now%a*(trial%t(1) + trial%t(2)) - 2.0_wp*(now%b*trial%t(3) + now%k)) &
            /(product + trial%g2*now%b*now%b_flow)
         gap = (trial%t(1) - trial%t(2))/(trial%g2*now%a_flow)
      else
         both = (2.0_wp*(now%a*trial%t(1) - now%k) - now%b*(trial%t(2) + trial%t(3))) &
            /(product + trial%g2*now%a*now%a_flow)
         gap = (trial%t(2) - trial%t(3))/(trial%g2*now%b_flow)
      end if
      one = 0.5_wp*(both + gap)
      two = 0.5_wp*(both - gap)
      if (flow%group == edge_of_maxima) then
         flow%x = [now%a_flow*one, now%a_flow*two, -now%b_flow*both]
      else
         flow%x = [now%a_flow*both, -now%b_flow*two, -now%b_flow*one]
      end if
      g = sqrt(2.0_wp*third*(flow%x(1)**2 + flow%x(2)**2 + flow%x(3)**2))
   end subroutine flow_on_edge

end module lithofrac_material_pyramid_return
