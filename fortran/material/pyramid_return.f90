!> The most frequent returns, to the compressive pyramid alone: several points at once.
!>
!> The plane of the extreme stresses by Newton's method (eqs 6-9 and 19 of Klerck, Sellers &
!> Owen 2004), the two edges next to it by the secant method. Both solve for the effective
!> plastic strain inside one segment of the tables. Whatever else a point needs (tension planes,
!> another segment, other edges) is left to `lithofrac_material_return_map`.
!>
!> Points go side by side through every loop, as the lanes of a vector register. None looks at
!> another: a point has the same bits in any company.
module lithofrac_material_pyramid_return
   use lithofrac_base_kinds, only: wp
   use lithofrac_material_active_sets, only: plane_bit
   use lithofrac_material_regularise, only: segment_of_band
   use lithofrac_material_rock, only: rock_type
   use lithofrac_material_tension_planes, only: softened_strength
   use lithofrac_math_angles, only: sine_cosine
   implicit none
   private

   public :: pack, padded, pyramid_return_type, return_to_pyramid

   integer, parameter :: pack = 32  !! points that are returned at once, at most
   integer, parameter :: lanes = 8  !! of the widest vector register: loops go over multiples

   real(wp), parameter :: third = 1.0_wp/3.0_wp
   real(wp), parameter :: gone = -1.0_wp  !! effective plastic strain of a point that was given up
   real(wp), parameter :: close = 1.0e-13_wp  !! relative error of a plastic strain increment
   real(wp), parameter :: tie_tolerance = 1.0e-2_wp  !! of the yield tolerance
   integer, parameter :: max_trips = 12

   !> What became of the points.
   type :: pyramid_return_type
      logical :: done(pack)        !! false: this point needs the general search
      real(wp) :: e(pack)          !! effective plastic strain [-]
      real(wp) :: dep(pack, 3)     !! inelastic strain increments along the given axes [-]
      real(wp) :: sin_phi(pack)    !! at that strain
      real(wp) :: c_cos_phi(pack)  !! [Pa]
      integer :: active(pack)      !! planes with flow, bits of `plane_bit`; 0: elastic
   end type pyramid_return_type

   !> Stresses in falling order, and the tables where they stand before the step.
   type :: start_type
      real(wp) :: t(pack, 3)       !! trial stresses [Pa]
      real(wp) :: rank(pack, 3)    !! of each axis: 1 has the largest stress
      real(wp) :: e(pack)          !! effective plastic strain before the step [-]
      real(wp) :: knot(pack)       !! where the next segment of the tables starts [-]
      real(wp) :: c(pack), phi(pack), psi(pack)  !! cohesion [Pa], friction, dilation [rad]
      real(wp) :: c_slope(pack), phi_slope(pack), psi_slope(pack)  !! by effective plastic strain
      real(wp) :: noise(pack)      !! rounding of a strain increment [-]
      real(wp) :: tie(pack)        !! stresses closer than this are equal [Pa]
   end type start_type

   !> Strength at one effective plastic strain of each point.
   type :: strength_type
      real(wp) :: c_slope(pack), c(pack)
      real(wp) :: sin_phi(pack), cos_phi(pack), sin_psi(pack), cos_psi(pack)
   end type strength_type

   !> Flow along the sorted axes.
   type :: sorted_flow_type
      real(wp) :: x(pack, 3)
      real(wp) :: s(pack, 3)
      real(wp) :: off(pack)        !! error of the plastic strain over its tolerance: done up to 0
   end type sorted_flow_type

contains

   !> Points in whole vectors: how many to hand over for `count` of them, the last one repeated.
   pure function padded(count) result(n)
      integer, intent(in) :: count
      integer :: n

      n = lanes*((count + lanes - 1)/lanes)
   end function padded

   !> Return points to the plane (1, 3), or to its edge with (2, 3) or (1, 2), where consistent.
   !> No point is done of a rock without compressive planes, or whose tension planes are checked
   !> with their old strength.
   pure subroutine return_to_pyramid(rock, n, h, trial, ft, e_old, found)
      type(rock_type), intent(in) :: rock
      integer, intent(in) :: n                   !! points, a number that is `padded`
      real(wp), intent(in) :: h(pack)            !! softening moduli, not positive [Pa]
      real(wp), intent(in) :: trial(pack, 3)     !! principal trial stresses, any order [Pa]
      real(wp), intent(in) :: ft(pack, 3)        !! tensile strengths of their axes [Pa]
      real(wp), intent(in) :: e_old(pack)        !! effective plastic strain before the step [-]
      type(pyramid_return_type), intent(out) :: found

      type(start_type) :: start
      type(sorted_flow_type) :: flow
      real(wp) :: beyond(pack)
      integer :: edge(pack), i
      logical :: opens(pack)

      found%done = .false.
      if (.not. rock%compression .or. rock%explicit_coupling) return
      call sort(rock, n, trial, start)
      call read_tables(rock, n, h, e_old, start)
      call return_to_main_plane(rock, n, start, found%e, flow, beyond)
      do i = 1, n
         edge(i) = 0
         if (.not. flow%off(i) <= 0.0_wp) cycle
         if (flow%s(i, 2) > flow%s(i, 1)) edge(i) = 1
         if (flow%s(i, 2) < flow%s(i, 3)) edge(i) = 2
      end do
      if (any(edge(:n) > 0)) call return_to_edges(rock, n, start, edge, found%e, flow)
      do i = 1, n
         opens(i) = any(trial(i, :) - ft(i, :) > rock%yield_tolerance)
      end do
      call finish(rock, n, h, trial, ft, start, flow, found)
      do i = 1, n
         if (opens(i)) found%done(i) = .false.
         found%active(i) = mask(start%rank(i, :), flow%x(i, :), edge(i))
         if (opens(i) .or. .not. beyond(i) <= rock%yield_tolerance) cycle
         found%done(i) = .true.
         found%active(i) = 0
      end do
   end subroutine return_to_pyramid

   !> Stresses in falling order; equal ones keep theirs.
   pure subroutine sort(rock, n, trial, start)
      type(rock_type), intent(in) :: rock
      integer, intent(in) :: n
      real(wp), intent(in) :: trial(pack, 3)
      type(start_type), intent(inout) :: start

      integer :: i
      real(wp) :: one, two, three, rounding, second_above, third_above, third_above_second

      !$omp simd private(one, two, three, rounding, second_above, third_above, third_above_second)
      do i = 1, n
         one = trial(i, 1)
         two = trial(i, 2)
         three = trial(i, 3)
         second_above = merge(1.0_wp, 0.0_wp, two > one)
         third_above = merge(1.0_wp, 0.0_wp, three > one)
         third_above_second = merge(1.0_wp, 0.0_wp, three > two)
         start%rank(i, 1) = 1.0_wp + second_above + third_above
         start%rank(i, 2) = 2.0_wp - second_above + third_above_second
         start%rank(i, 3) = 3.0_wp - third_above - third_above_second
         start%t(i, 1) = max(one, two, three)
         start%t(i, 2) = max(min(one, two), min(max(one, two), three))
         start%t(i, 3) = min(one, two, three)
         rounding = 8.0_wp*epsilon(1.0_wp)*max(abs(start%t(i, 1)), abs(start%t(i, 3)))
         start%tie(i) = max(tie_tolerance*rock%yield_tolerance, rounding)
      end do
   end subroutine sort

   !> Segments of the tables in which the points stand.
   pure subroutine read_tables(rock, n, h, e_old, start)
      type(rock_type), intent(in) :: rock
      integer, intent(in) :: n
      real(wp), intent(in) :: h(pack)
      real(wp), intent(in) :: e_old(pack)
      type(start_type), intent(inout) :: start

      integer :: i, segment
      real(wp) :: origin, past, stretch

      start%e(:n) = e_old(:n)
      do i = 1, n
         call segment_of_band(rock, h(i), e_old(i), segment, origin, start%knot(i), stretch)
         past = e_old(i) - origin
         start%c_slope(i) = rock%cohesion%slope(segment)/stretch
         start%phi_slope(i) = rock%friction%slope(segment)/stretch
         start%psi_slope(i) = rock%dilation%slope(segment)/stretch
         start%c(i) = rock%cohesion%y(segment) + start%c_slope(i)*past
         start%phi(i) = rock%friction%y(segment) + start%phi_slope(i)*past
         start%psi(i) = rock%dilation%y(segment) + start%psi_slope(i)*past
      end do
      start%noise(:n) = 2.0_wp*epsilon(1.0_wp)*(e_old(:n) + (abs(start%t(:n, 1)) &
         + abs(start%t(:n, 3)) + rock%strength_scale)/(2.0_wp*rock%shear))
   end subroutine read_tables

   !> Cohesion, and the sines and cosines of friction and dilation, at a plastic strain.
   pure subroutine strength_at(n, start, e, now)
      integer, intent(in) :: n
      type(start_type), intent(in) :: start
      real(wp), intent(in) :: e(pack)
      type(strength_type), intent(inout) :: now

      real(wp) :: past
      integer :: i
      real(wp) :: phi(pack), psi(pack)

      do i = 1, n
         past = e(i) - start%e(i)
         now%c(i) = start%c(i) + start%c_slope(i)*past
         phi(i) = start%phi(i) + start%phi_slope(i)*past
         psi(i) = start%psi(i) + start%psi_slope(i)*past
      end do
      call sine_cosine(n, phi, now%sin_phi, now%cos_phi)
      call sine_cosine(n, psi, now%sin_psi, now%cos_psi)
   end subroutine strength_at

   !> Newton's method on the plane of the extreme stresses.
   pure subroutine return_to_main_plane(rock, n, start, e, flow, beyond)
      type(rock_type), intent(in) :: rock
      integer, intent(in) :: n
      type(start_type), intent(in) :: start
      real(wp), intent(out) :: e(pack)
      type(sorted_flow_type), intent(inout) :: flow
      real(wp), intent(out) :: beyond(pack)   !! yield function of the trial stress [Pa]

      type(strength_type) :: now
      integer :: i, trip
      real(wp) :: f_slope, g, g_slope, give, k_slope, lambda, next, norm, over, product, stiff, &
         stiff_slope, volume, worst

      stiff = rock%shear + rock%lame
      e(:n) = start%e(:n)
      do trip = 1, max_trips
         call strength_at(n, start, e, now)
         worst = -1.0_wp
         !$omp simd private(f_slope, g, g_slope, give, k_slope, lambda, next, norm, over) &
         !$omp& private(product, stiff_slope) reduction(max:worst)
         do i = 1, n
            product = now%sin_phi(i)*now%sin_psi(i)
            norm = sqrt(third*(1.0_wp + now%sin_psi(i)**2))
            give = 1.0_wp/(rock%shear + stiff*product)
            over = 0.5_wp*(1.0_wp + now%sin_phi(i))*start%t(i, 1) &
               - 0.5_wp*(1.0_wp - now%sin_phi(i))*start%t(i, 3) - now%c(i)*now%cos_phi(i)
            if (trip == 1) beyond(i) = over
            lambda = over*give
            g = norm*lambda
            flow%off(i) = abs(e(i) - start%e(i) - g) - (close*g + start%noise(i))
            flow%x(i, 1) = 0.5_wp*(1.0_wp + now%sin_psi(i))*lambda
            flow%x(i, 3) = -0.5_wp*(1.0_wp - now%sin_psi(i))*lambda
            k_slope = start%c_slope(i)*now%cos_phi(i) - now%c(i)*now%sin_phi(i)*start%phi_slope(i)
            f_slope = 0.5_wp*(start%t(i, 1) + start%t(i, 3))*now%cos_phi(i)*start%phi_slope(i) &
               - k_slope
            stiff_slope = stiff*(now%cos_phi(i)*start%phi_slope(i)*now%sin_psi(i) &
               + now%sin_phi(i)*now%cos_psi(i)*start%psi_slope(i))
            g_slope = norm*give*(f_slope - lambda*stiff_slope) &
               + third*lambda*now%sin_psi(i)*now%cos_psi(i)*start%psi_slope(i)/norm
            next = e(i) + (start%e(i) + g - e(i))/(1.0_wp - g_slope)
            next = merge(next, gone, &
               g_slope < 1.0_wp .and. next >= start%e(i) .and. next <= start%knot(i))
            e(i) = merge(e(i), next, flow%off(i) <= 0.0_wp)
            worst = max(worst, merge(flow%off(i), -1.0_wp, e(i) >= 0.0_wp))
         end do
         if (worst <= 0.0_wp) exit
      end do
      !$omp simd private(volume)
      do i = 1, n
         flow%x(i, 2) = 0.0_wp
         volume = rock%lame*(flow%x(i, 1) + flow%x(i, 3))
         flow%s(i, 1) = start%t(i, 1) - 2.0_wp*rock%shear*flow%x(i, 1) - volume
         flow%s(i, 2) = start%t(i, 2) - volume
         flow%s(i, 3) = start%t(i, 3) - 2.0_wp*rock%shear*flow%x(i, 3) - volume
         ! A plane can only push: x(1) has the sign of the multiplier.
         flow%off(i) = merge(flow%off(i), 1.0_wp, flow%x(i, 1) >= 0.0_wp .and. e(i) >= start%e(i))
      end do
   end subroutine return_to_main_plane

   !> Secant method on the edges, from the strain of the main plane.
   pure subroutine return_to_edges(rock, n, start, edge, e, flow)
      type(rock_type), intent(in) :: rock
      integer, intent(in) :: n
      type(start_type), intent(in) :: start
      integer, intent(in) :: edge(pack)   !! 1: of the two largest stresses; 2: of the smallest
      real(wp), intent(inout) :: e(pack)
      type(sorted_flow_type), intent(inout) :: flow

      real(wp), dimension(pack) :: before, g, miss_before, off
      real(wp) :: miss, next, volume, x(pack, 3)
      logical :: pending(pack)
      integer :: i, trip

      before(:n) = start%e(:n)
      call flow_on_edge(rock, n, start, edge, before, x, g)
      miss_before(:n) = -g(:n)
      off(:n) = 1.0_wp
      pending(:n) = edge(:n) > 0
      do trip = 1, max_trips
         pending(:n) = pending(:n) .and. e(:n) > start%e(:n) .and. e(:n) <= start%knot(:n)
         if (.not. any(pending(:n))) exit
         call flow_on_edge(rock, n, start, edge, e, x, g)
         do i = 1, n
            if (.not. pending(i)) cycle
            miss = e(i) - start%e(i) - g(i)
            off(i) = abs(miss) - (close*g(i) + start%noise(i))
            pending(i) = off(i) > 0.0_wp .and. abs(miss - miss_before(i)) > 0.0_wp
            if (off(i) <= 0.0_wp) flow%x(i, :) = x(i, :)
            if (.not. pending(i)) cycle
            next = e(i) - miss*(e(i) - before(i))/(miss - miss_before(i))
            before(i) = e(i)
            miss_before(i) = miss
            e(i) = next
         end do
      end do
      do i = 1, n
         if (edge(i) == 0) cycle
         flow%off(i) = off(i)
         if (.not. off(i) <= 0.0_wp) cycle
         volume = rock%lame*sum(flow%x(i, :))
         flow%s(i, :) = start%t(i, :) - 2.0_wp*rock%shear*flow%x(i, :) - volume
         if (edge(i) == 1 .and. min(flow%x(i, 1), flow%x(i, 2)) < 0.0_wp) flow%off(i) = 1.0_wp
         if (edge(i) == 2 .and. max(flow%x(i, 2), flow%x(i, 3)) > 0.0_wp) flow%off(i) = 1.0_wp
      end do
   end subroutine return_to_edges

   !> Flow to an edge at fixed strength. By symmetry the sum and the difference of the two
   !> multipliers decouple; the difference closes the gap between the two equal stresses.
   pure subroutine flow_on_edge(rock, n, start, edge, e, x, g)
      type(rock_type), intent(in) :: rock
      integer, intent(in) :: n
      type(start_type), intent(in) :: start
      integer, intent(in) :: edge(pack)
      real(wp), intent(in) :: e(pack)
      real(wp), intent(out) :: x(pack, 3)  !! along the sorted axes [-]
      real(wp), intent(out) :: g(pack)     !! effective plastic strain increment [-]

      type(strength_type) :: now
      integer :: i
      real(wp) :: a, a_flow, b, b_flow, both, gap, k, one, product, two
      logical :: maxima

      call strength_at(n, start, e, now)
      !$omp simd private(a, a_flow, b, b_flow, both, gap, k, one, product, two, maxima)
      do i = 1, n
         maxima = edge(i) == 1
         a = 0.5_wp*(1.0_wp + now%sin_phi(i))
         b = 0.5_wp*(1.0_wp - now%sin_phi(i))
         a_flow = 0.5_wp*(1.0_wp + now%sin_psi(i))
         b_flow = 0.5_wp*(1.0_wp - now%sin_psi(i))
         k = now%c(i)*now%cos_phi(i)
         product = (rock%shear + 2.0_wp*rock%lame)*now%sin_phi(i)*now%sin_psi(i) + rock%shear &
            + 2.0_wp*rock%shear*merge(b*b_flow, a*a_flow, maxima)
         both = merge(a*(start%t(i, 1) + start%t(i, 2)) - 2.0_wp*(b*start%t(i, 3) + k), &
            2.0_wp*(a*start%t(i, 1) - k) - b*(start%t(i, 2) + start%t(i, 3)), maxima)/product
         gap = merge(start%t(i, 1) - start%t(i, 2), start%t(i, 2) - start%t(i, 3), maxima) &
            /(2.0_wp*rock%shear*merge(a_flow, b_flow, maxima))
         one = 0.5_wp*(both + gap)
         two = 0.5_wp*(both - gap)
         x(i, 1) = a_flow*merge(one, both, maxima)
         x(i, 2) = merge(a_flow, -b_flow, maxima)*two
         x(i, 3) = -b_flow*merge(both, one, maxima)
         g(i) = sqrt(2.0_wp*third*(x(i, 1)**2 + x(i, 2)**2 + x(i, 3)**2))
      end do
   end subroutine flow_on_edge

   !> Flow along the axes as they were given, and whether all planes allow the stress.
   pure subroutine finish(rock, n, h, trial, ft, start, flow, found)
      type(rock_type), intent(in) :: rock
      integer, intent(in) :: n
      real(wp), intent(in) :: h(pack)
      real(wp), intent(in) :: trial(pack, 3)
      real(wp), intent(in) :: ft(pack, 3)
      type(start_type), intent(in) :: start
      type(sorted_flow_type), intent(in) :: flow
      type(pyramid_return_type), intent(inout) :: found

      type(strength_type) :: now
      integer :: axis, i
      real(wp) :: volume, s

      call strength_at(n, start, found%e, now)
      do i = 1, n
         found%sin_phi(i) = now%sin_phi(i)
         found%c_cos_phi(i) = now%c(i)*now%cos_phi(i)
         found%done(i) = flow%off(i) <= 0.0_wp &
            .and. flow%s(i, 1) >= max(flow%s(i, 2), flow%s(i, 3)) - start%tie(i)
      end do
      do axis = 1, 3
         do i = 1, n
            found%dep(i, axis) = merge(flow%x(i, 1), &
               merge(flow%x(i, 2), flow%x(i, 3), start%rank(i, axis) < 2.5_wp), &
               start%rank(i, axis) < 1.5_wp)
            volume = rock%lame*(flow%x(i, 1) + flow%x(i, 2) + flow%x(i, 3))
            s = trial(i, axis) - 2.0_wp*rock%shear*found%dep(i, axis) - volume
            found%done(i) = found%done(i) .and. &
               s <= softened_strength(ft(i, axis), h(i), found%dep(i, axis))
         end do
      end do
   end subroutine finish

   !> Planes with flow.
   pure function mask(rank, x, edge)
      real(wp), intent(in) :: rank(3)  !! of each axis
      real(wp), intent(in) :: x(3)     !! flow along the sorted axes [-]
      integer, intent(in) :: edge      !! 0: plane of the extreme stresses; see `return_to_edges`
      integer :: mask

      integer :: order(3)

      order(nint(rank)) = [1, 2, 3]
      mask = 0
      if (edge /= 1 .or. abs(x(1)) > 0.0_wp) then
         if (edge /= 2 .or. abs(x(3)) > 0.0_wp) mask = ibset(mask, plane_bit(order(1), order(3)))
      end if
      if (edge == 1 .and. abs(x(2)) > 0.0_wp) mask = ibset(mask, plane_bit(order(2), order(3)))
      if (edge == 2 .and. abs(x(2)) > 0.0_wp) mask = ibset(mask, plane_bit(order(1), order(2)))
   end function mask

end module lithofrac_material_pyramid_return
