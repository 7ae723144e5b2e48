!> Constants of one rock, checked once and plain to read.
!>
!> Elasticity, tensile strength and fracture energy, and the mobilised cohesion,
!> friction and dilation of Klerck, Sellers & Owen 2004, section 2.2 and Table 1.
!> Beyond the paper: a reference width, see `lithofrac_material_regularise`.
!> Conventions of the whole library: tension is positive, SI units, radians.
module lithofrac_material_rock
   use lithofrac_base_kinds, only: pi, wp
   use lithofrac_base_status, only: bad_input, ok, set_failure, status_type
   use lithofrac_material_table, only: new_table, table_type
   use lithofrac_math_angles, only: sine_cosine
   implicit none
   private

   public :: rock_type, new_rock

   real(wp), parameter :: never = 1.0e30_wp           !! strength no stress reaches [Pa]
   real(wp), parameter :: relative_tolerance = 1.0e-10_wp

   !> What a material point needs to know of its rock.
   type :: rock_type
      real(wp) :: young = 0.0_wp              !! Young's modulus [Pa]
      real(wp) :: poisson = 0.0_wp            !! Poisson's ratio [-]
      real(wp) :: density = 0.0_wp            !! [kg/m3]
      real(wp) :: tensile_strength = 0.0_wp   !! virgin tensile strength ft [Pa]
      real(wp) :: fracture_energy = 0.0_wp    !! Gf [J/m2]
      real(wp) :: bulk = 0.0_wp               !! K [Pa]
      real(wp) :: shear = 0.0_wp              !! G [Pa]
      real(wp) :: lame = 0.0_wp               !! lambda = K - 2 G/3 [Pa]
      real(wp) :: strength_scale = 1.0_wp     !! virgin strength, larger than zero [Pa]
      real(wp) :: yield_tolerance = 0.0_wp    !! f up to here is elastic [Pa]
      real(wp) :: sin_phi0 = 0.0_wp           !! sine of the virgin friction angle [-]
      real(wp) :: c_cos_phi0 = never          !! virgin c cos phi [Pa]
      type(table_type) :: cohesion            !! [Pa] over effective plastic strain
      type(table_type) :: friction            !! [rad] over effective plastic strain
      type(table_type) :: dilation            !! [rad] over effective plastic strain
      real(wp) :: reference_width = 0.0_wp    !! band that softens as the table says [m], 0: any
      integer :: onset = 0                    !! row of the tables where softening starts
      logical :: total_hardening = .false.    !! tension feeds the effective plastic strain too
      logical :: explicit_coupling = .false.  !! planes are checked with their old strength
      logical :: compression = .true.         !! Mohr-Coulomb planes exist
      logical :: yields = .true.              !! false: elastic for ever (steel)
   end type rock_type

contains

   !> Build a rock, or say in words which number makes no sense.
   pure subroutine new_rock(rock, constants, table, options, status)
      type(rock_type), intent(out) :: rock
      real(wp), intent(in) :: constants(6)     !! E [Pa], nu, density [kg/m3], ft [Pa], Gf [J/m2],
                                               !! reference width [m] or 0
      real(wp), intent(in) :: table(:, :)      !! (4, k): strain, c [Pa], phi [rad], psi [rad]
      integer, intent(in) :: options(4)        !! total, explicit, compression, yields (0 or 1)
      type(status_type), intent(out) :: status

      rock%young = constants(1)
      rock%poisson = constants(2)
      rock%density = constants(3)
      rock%tensile_strength = constants(4)
      rock%fracture_energy = constants(5)
      rock%reference_width = constants(6)
      rock%total_hardening = options(1) == 1
      rock%explicit_coupling = options(2) == 1
      rock%compression = options(3) == 1
      rock%yields = options(4) == 1
      call check_constants(rock, options, status)
      if (status%code /= ok) return
      rock%shear = rock%young/(2.0_wp*(1.0_wp + rock%poisson))
      rock%bulk = rock%young/(3.0_wp*(1.0_wp - 2.0_wp*rock%poisson))
      rock%lame = rock%young*rock%poisson/((1.0_wp + rock%poisson)*(1.0_wp - 2.0_wp*rock%poisson))
      rock%compression = rock%compression .and. rock%yields
      if (rock%compression) call set_tables(rock, table, status)
      if (status%code /= ok) return
      call set_onset(rock, status)
      if (status%code /= ok) return
      call set_scales(rock)
   end subroutine new_rock

   pure subroutine check_constants(rock, options, status)
      type(rock_type), intent(in) :: rock
      integer, intent(in) :: options(4)
      type(status_type), intent(out) :: status

      if (any(options < 0 .or. options > 1)) then
         call set_failure(status, bad_input, "rock: every option must be 0 or 1")
      else if (.not. positive(rock%young)) then
         call set_failure(status, bad_input, "rock: Young's modulus must be positive")
      else if (.not. (rock%poisson > -1.0_wp .and. rock%poisson < 0.5_wp)) then
         call set_failure(status, bad_input, "rock: Poisson's ratio must lie between -1 and 0.5")
      else if (.not. positive(rock%density)) then
         call set_failure(status, bad_input, "rock: density must be positive")
      else if (rock%yields .and. .not. positive(rock%tensile_strength)) then
         call set_failure(status, bad_input, "rock: tensile strength must be positive")
      else if (rock%yields .and. .not. positive(rock%fracture_energy)) then
         call set_failure(status, bad_input, "rock: fracture energy must be positive")
      else if (rock%reference_width < 0.0_wp .or. .not. rock%reference_width <= huge(1.0_wp)) then
         call set_failure(status, bad_input, "rock: reference width must be 0 or positive")
      end if
   end subroutine check_constants

   pure subroutine set_tables(rock, table, status)
      type(rock_type), intent(inout) :: rock
      real(wp), intent(in) :: table(:, :)
      type(status_type), intent(out) :: status

      if (size(table, 1) /= 4) then
         call set_failure(status, bad_input, "rock: the table needs four rows")
         return
      end if
      call new_table(rock%cohesion, table(1, :), table(2, :), status)
      if (status%code == ok) call new_table(rock%friction, table(1, :), table(3, :), status)
      if (status%code == ok) call new_table(rock%dilation, table(1, :), table(4, :), status)
      if (status%code /= ok) return
      if (any(table(2, :) < 0.0_wp)) then
         call set_failure(status, bad_input, "rock: cohesion must not be negative")
      else if (any(table(3, :) < 0.0_wp .or. table(3, :) >= 0.5_wp*pi)) then
         call set_failure(status, bad_input, &
            "rock: friction must be at least 0 and below 90 degrees")
      else if (any(table(4, :) < 0.0_wp .or. table(4, :) >= 0.5_wp*pi)) then
         call set_failure(status, bad_input, &
            "rock: dilation must be at least 0 and below 90 degrees")
      end if
   end subroutine set_tables

   !> Find the row where softening starts: that of the largest uniaxial strength.
   !>
   !> Choice: cohesion alone falls from the first row on while friction still rises, so that
   !> its fall is no softening; under confinement the strength peaks in the same row or a later
   !> one (test_regularise).
   pure subroutine set_onset(rock, status)
      type(rock_type), intent(inout) :: rock
      type(status_type), intent(out) :: status

      if (.not. rock%reference_width > 0.0_wp) return
      if (.not. rock%compression) then
         call set_failure(status, bad_input, "rock: a reference width needs Mohr-Coulomb planes")
         return
      end if
      associate (n => rock%cohesion%n, c => rock%cohesion%y, phi => rock%friction%y)
         rock%onset = maxloc(c(1:n)*cos(phi(1:n))/(1.0_wp - sin(phi(1:n))), 1, back=.true.)
         if (rock%onset == n) call set_failure(status, bad_input, &
            "rock: a reference width needs a table that softens")
      end associate
   end subroutine set_onset

   pure subroutine set_scales(rock)
      type(rock_type), intent(inout) :: rock

      real(wp) :: sine(1), cosine(1)

      rock%strength_scale = rock%tensile_strength
      if (rock%compression) then
         associate (cohesion => rock%cohesion%y(:rock%cohesion%n))  ! planes out of reach set none
            rock%strength_scale = max(rock%strength_scale, maxval(cohesion, cohesion < never))
         end associate
         call sine_cosine(1, rock%friction%y(0:0), sine, cosine)
         rock%sin_phi0 = sine(1)
         rock%c_cos_phi0 = rock%cohesion%y(0)*cosine(1)
      end if
      if (.not. rock%strength_scale > 0.0_wp) rock%strength_scale = rock%young
      rock%yield_tolerance = relative_tolerance*rock%strength_scale
   end subroutine set_scales

   !> True for a finite number above zero, false for NaN.
   pure function positive(x)
      real(wp), intent(in) :: x
      logical :: positive

      positive = x > 0.0_wp .and. x <= huge(x)
   end function positive

end module lithofrac_material_rock
