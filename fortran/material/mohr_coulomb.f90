!> Mobilised Mohr-Coulomb strength (Klerck, Sellers & Owen 2004, eqs 5-8).
!>
!> Plane (i, j), with i the larger and j the smaller principal stress:
!>    f = a sigma_i - b sigma_j - k,  a, b = (1 +- sin phi)/2,  k = c cos phi   (eq. 6)
!>    flow: a_flow on i, -b_flow on j, the same with the dilation angle psi      (eq. 8)
!> The factor 1/2 only rescales the plastic multiplier of eq. 19.
!> This module knows nothing of tension planes.
module lithofrac_material_mohr_coulomb
   use lithofrac_base_kinds, only: wp
   use lithofrac_material_rock, only: rock_type
   use lithofrac_material_table, only: table_segment
   implicit none
   private

   public :: mobilised_type, mobilise, advance, strength_coefficients, main_plane_yield

   real(wp), parameter :: small_turn = 0.06_wp  !! angle whose ninth power is rounding [rad]

   !> Strength and flow at one effective plastic strain.
   type :: mobilised_type
      real(wp) :: a, b        !! yield: (1 + sin phi)/2, (1 - sin phi)/2 [-]
      real(wp) :: k           !! c cos phi [Pa]
      real(wp) :: a_flow, b_flow  !! flow: the same with psi [-]
      real(wp) :: sin_phi, sin_psi
      real(wp) :: cos_phi, cos_psi
      real(wp) :: c                             !! cohesion [Pa]
      real(wp) :: c_slope, phi_slope, psi_slope !! derivatives by effective plastic strain
      real(wp) :: knot        !! effective plastic strain where the next segment starts
   end type mobilised_type

contains

   !> Strength and flow at the effective plastic strain `ep_eff`.
   !> The tables share their knots: one search serves all three.
   pure subroutine mobilise(rock, ep_eff, now)
      type(rock_type), intent(in) :: rock
      real(wp), intent(in) :: ep_eff            !! [-]
      type(mobilised_type), intent(out) :: now

      integer :: i
      real(wp) :: past, phi

      i = table_segment(rock%cohesion, ep_eff)
      past = ep_eff - rock%cohesion%origin(i)
      now%knot = huge(1.0_wp)
      if (i < rock%cohesion%n) now%knot = rock%cohesion%x(i + 1)
      now%c_slope = rock%cohesion%slope(i)
      now%phi_slope = rock%friction%slope(i)
      now%psi_slope = rock%dilation%slope(i)
      now%c = rock%cohesion%y(i) + now%c_slope*past
      phi = rock%friction%y(i) + now%phi_slope*past
      now%sin_phi = sin(phi)
      now%cos_phi = cos(phi)
      now%sin_psi = sin(rock%dilation%y(i) + now%psi_slope*past)
      now%cos_psi = sqrt(max(0.0_wp, 1.0_wp - now%sin_psi**2))
      now%k = now%c*now%cos_phi
      now%a = 0.5_wp*(1.0_wp + now%sin_phi)
      now%b = 0.5_wp*(1.0_wp - now%sin_phi)
      now%a_flow = 0.5_wp*(1.0_wp + now%sin_psi)
      now%b_flow = 0.5_wp*(1.0_wp - now%sin_psi)
   end subroutine mobilise

   !> Strength and flow after a small increment of effective plastic strain in one segment.
   !> The sine and cosine of the old angles are turned: no library call in the hot loop.
   pure subroutine advance(rock, start, e_start, ep_eff, now)
      type(rock_type), intent(in) :: rock
      type(mobilised_type), intent(in) :: start  !! at `e_start`
      real(wp), intent(in) :: e_start            !! [-]
      real(wp), intent(in) :: ep_eff             !! [-], `e_start` or more
      type(mobilised_type), intent(out) :: now

      real(wp) :: past, turn_phi, turn_psi

      past = ep_eff - e_start
      turn_phi = start%phi_slope*past
      turn_psi = start%psi_slope*past
      if (max(abs(turn_phi), abs(turn_psi)) > small_turn .or. ep_eff > start%knot) then
         call mobilise(rock, ep_eff, now)
         return
      end if
      now = start
      now%c = start%c + start%c_slope*past
      call turn(turn_phi, now%sin_phi, now%cos_phi)
      call turn(turn_psi, now%sin_psi, now%cos_psi)
      now%k = now%c*now%cos_phi
      now%a = 0.5_wp*(1.0_wp + now%sin_phi)
      now%b = 0.5_wp*(1.0_wp - now%sin_phi)
      now%a_flow = 0.5_wp*(1.0_wp + now%sin_psi)
      now%b_flow = 0.5_wp*(1.0_wp - now%sin_psi)
   end subroutine advance

   !> Sine and cosine of an angle that grows by `by`, at most `small_turn`.
   pure subroutine turn(by, sine, cosine)
      real(wp), intent(in) :: by  !! [rad]
      real(wp), intent(inout) :: sine, cosine

      real(wp), parameter :: series(2:8) = [-1.0_wp/2.0_wp, -1.0_wp/6.0_wp, 1.0_wp/24.0_wp, &
         1.0_wp/120.0_wp, -1.0_wp/720.0_wp, -1.0_wp/5040.0_wp, 1.0_wp/40320.0_wp]
      real(wp) :: cos_by, old, q, sin_by

      q = by*by
      sin_by = by*(1.0_wp + q*(series(3) + q*(series(5) + q*series(7))))
      cos_by = 1.0_wp + q*(series(2) + q*(series(4) + q*(series(6) + q*series(8))))
      old = sine
      sine = old*cos_by + cosine*sin_by
      cosine = cosine*cos_by - old*sin_by
   end subroutine turn

   !> sin(phi) and c cos(phi) [Pa]: all that a yield check needs.
   pure subroutine strength_coefficients(rock, ep_eff, sin_phi, c_cos_phi)
      type(rock_type), intent(in) :: rock
      real(wp), intent(in) :: ep_eff      !! effective plastic strain [-]
      real(wp), intent(out) :: sin_phi    !! [-]
      real(wp), intent(out) :: c_cos_phi  !! [Pa]

      type(mobilised_type) :: now

      sin_phi = rock%sin_phi0
      c_cos_phi = rock%c_cos_phi0
      if (.not. rock%compression) return
      call mobilise(rock, ep_eff, now)
      sin_phi = now%sin_phi
      c_cos_phi = now%k
   end subroutine strength_coefficients

   !> Largest of the six yield functions [Pa]: the plane of the extreme stresses.
   pure function main_plane_yield(now, sigma) result(f)
      type(mobilised_type), intent(in) :: now
      real(wp), intent(in) :: sigma(3)  !! principal stresses, any order [Pa]
      real(wp) :: f

      f = now%a*maxval(sigma) - now%b*minval(sigma) - now%k
   end function main_plane_yield

end module lithofrac_material_mohr_coulomb
