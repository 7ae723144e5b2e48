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
   use lithofrac_math_angles, only: sine_cosine
   implicit none
   private

   public :: mobilised_type, mobilise, strength_coefficients, main_plane_yield

   !> Strength and flow at one effective plastic strain.
   type :: mobilised_type
      real(wp) :: a, b        !! yield: (1 + sin phi)/2, (1 - sin phi)/2 [-]
      real(wp) :: k           !! c cos phi [Pa]
      real(wp) :: a_flow, b_flow  !! flow: the same with psi [-]
      real(wp) :: sin_phi, sin_psi
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
      real(wp) :: past, sine(2), cosine(2)

      i = table_segment(rock%cohesion, ep_eff)
      past = ep_eff - rock%cohesion%origin(i)
      now%knot = huge(1.0_wp)
      if (i < rock%cohesion%n) now%knot = rock%cohesion%x(i + 1)
      call sine_cosine(2, [rock%friction%y(i) + rock%friction%slope(i)*past, &
         rock%dilation%y(i) + rock%dilation%slope(i)*past], sine, cosine)
      now%sin_phi = sine(1)
      now%sin_psi = sine(2)
      now%k = (rock%cohesion%y(i) + rock%cohesion%slope(i)*past)*cosine(1)
      now%a = 0.5_wp*(1.0_wp + now%sin_phi)
      now%b = 0.5_wp*(1.0_wp - now%sin_phi)
      now%a_flow = 0.5_wp*(1.0_wp + now%sin_psi)
      now%b_flow = 0.5_wp*(1.0_wp - now%sin_psi)
   end subroutine mobilise

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
