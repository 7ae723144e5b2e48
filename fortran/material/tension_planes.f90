!> Three independent tension planes with linear softening
!> (Klerck, Sellers & Owen 2004, eqs 14-18).
module lithofrac_material_tension_planes
   use lithofrac_base_kinds, only: wp
   use lithofrac_material_rock, only: rock_type
   implicit none
   private

   public :: softening_modulus, softened_strength, band_width, band_width_limit

contains

   !> H [Pa], not positive (eq. 16): constant, from the virgin strength.
   pure function softening_modulus(rock, hc) result(h)
      type(rock_type), intent(in) :: rock
      real(wp), intent(in) :: hc  !! crack band width [m]
      real(wp) :: h

      h = 0.0_wp
      if (rock%yields) h = -hc*rock%tensile_strength**2/(2.0_wp*rock%fracture_energy)
   end function softening_modulus

   !> Strength after an inelastic strain increment along the plane's normal (eqs 17, 18, 20).
   elemental function softened_strength(ft, h, dep) result(strength)
      real(wp), intent(in) :: ft   !! strength before [Pa]
      real(wp), intent(in) :: h    !! softening modulus, not positive [Pa]
      real(wp), intent(in) :: dep  !! inelastic strain increment, any cause [-]
      real(wp) :: strength

      strength = max(0.0_wp, ft + h*max(0.0_wp, dep))
   end function softened_strength

   !> Crack band width of a triangle [m]: leg of the right isosceles triangle of equal area.
   !> Choice: the paper says "average dimension"; `scale` sqrt(2) or 1 (test_tension_planes).
   elemental function band_width(area, scale) result(hc)
      real(wp), intent(in) :: area   !! [m2]
      real(wp), intent(in) :: scale  !! sqrt(2) or 1
      real(wp) :: hc

      hc = scale*sqrt(area)
   end function band_width

   !> Largest band width [m] with one answer for several active planes: |H| = 2 G.
   !> The usual 2 E Gf/ft^2 is not sufficient.
   pure function band_width_limit(rock) result(hc)
      type(rock_type), intent(in) :: rock
      real(wp) :: hc

      hc = huge(1.0_wp)
      if (rock%yields) hc = 4.0_wp*rock%shear*rock%fracture_energy/rock%tensile_strength**2
   end function band_width_limit

end module lithofrac_material_tension_planes
