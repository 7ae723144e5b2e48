!> Stress update of one material point: axes, return mapping, softening.
!>
!> An elastic trial stress comes in, stress and inelastic strain go out, and the state of the
!> point moves on (Klerck, Sellers & Owen 2004, sections 2.2-2.4). The principal directions are
!> those of the trial stress. Components are xx, yy, zz, xy; shear strain is engineering.
module lithofrac_material_stress_update
   use lithofrac_base_kinds, only: wp
   use lithofrac_base_status, only: no_return_map, ok
   use lithofrac_material_crack_axes, only: follow_axes, turn_crack
   use lithofrac_material_mohr_coulomb, only: strength_coefficients
   use lithofrac_material_pyramid_return, only: pack, padded, pyramid_return_type, &
      return_to_pyramid
   use lithofrac_material_regularise, only: regularises, rock_of_band, table_strain
   use lithofrac_material_return_map, only: return_to_surface
   use lithofrac_material_rock, only: rock_type
   use lithofrac_material_tension_planes, only: softened_strength, softening_modulus
   use lithofrac_math_principal, only: normal_components, tensor_from_axes
   implicit none
   private

   public :: point_type, virgin_point, update_pack, strength_of_band, softening_modulus
   public :: substep_bit

   integer, parameter :: substep_bit = 11  !! set in `active` when the step was cut
   integer, parameter :: max_halvings = 8

   !> History of one material point.
   type :: point_type
      real(wp) :: ep_eff = 0.0_wp      !! effective plastic strain [-], eq. 7
      real(wp) :: ft(3) = 0.0_wp       !! tensile strengths [Pa]: first axis, 90 degrees to it, zz
      real(wp) :: opening(3) = 0.0_wp  !! positive inelastic strain along the same axes [-]
      real(wp) :: axis(2) = [1.0_wp, 0.0_wp]  !! cos 2a, sin 2a of the first in-plane axis
      real(wp) :: crack(2) = 0.0_wp    !! eq. 13: sum of damage times doubled direction [-]
   end type point_type

contains

   !> A point that has seen no inelastic strain.
   pure function virgin_point(rock) result(point)
      type(rock_type), intent(in) :: rock
      type(point_type) :: point

      point%ft = rock%tensile_strength
   end function virgin_point

   !> Take one step of up to `pack` points. `sigma = trial - C : dep` holds to rounding.
   !> What each gets does not depend on the others.
   !>
   !> `active` is zero for an elastic step. Its bits 0 to 2 are the tension planes of axes 1 to
   !> 3 of the point, bits 3 to 8 the Mohr-Coulomb planes (larger, smaller stress) = (1,2),
   !> (1,3), (2,1), (2,3), (3,1), (3,2), bit 9 the apex, bit 10 a mixture of two sets that
   !> share their stress, bit 11 a step that was cut (then the planes of all parts).
   !> On `code == no_return_map` point and stress stay as they were at the start of the step.
   pure subroutine update_pack(rock, count, softening, old, trial, point, sigma, dep, &
      dep_compressive, strength, active, code)
      type(rock_type), intent(in) :: rock
      integer, intent(in) :: count                 !! points, 1 to `pack`
      real(wp), intent(in) :: softening(pack)      !! H, not positive [Pa]
      real(wp), intent(in) :: old(4, pack)         !! stress at the start of the step [Pa]
      real(wp), intent(in) :: trial(4, pack)       !! elastic trial stress [Pa]
      type(point_type), intent(inout) :: point(pack)
      real(wp), intent(out) :: sigma(4, pack)      !! stress at the end of the step [Pa]
      real(wp), intent(out) :: dep(4, pack)        !! inelastic strain increment [-]
      real(wp), intent(out) :: dep_compressive(4, pack)  !! its Mohr-Coulomb part [-]
      real(wp), intent(out) :: strength(2, pack)   !! sin(phi), c cos(phi) [Pa] of points that flow
      integer, intent(out) :: active(pack)         !! planes with flow
      integer, intent(out) :: code(pack)           !! `ok` or `no_return_map`

      type(pyramid_return_type) :: quick
      integer :: i, lane
      real(wp) :: axis(pack, 2), ep_eff(pack), ft(pack, 3), normal(pack, 3), slope(pack)

      sigma(:, :count) = trial(:, :count)
      dep(:, :count) = 0.0_wp
      dep_compressive(:, :count) = 0.0_wp
      active(:count) = 0
      code(:count) = ok
      if (.not. rock%yields) return
      do lane = 1, padded(count)
         i = min(lane, count)
         axis(lane, :) = point(i)%axis
         call follow_axes(trial(:, i), axis(lane, :))
         normal(lane, :) = normal_components(trial(:, i), axis(lane, :))
         ft(lane, :) = point(i)%ft
         ep_eff(lane) = point(i)%ep_eff
         slope(lane) = softening(i)
      end do
      call return_to_pyramid(rock, padded(count), slope, normal, ft, ep_eff, quick)
      do i = 1, count
         if (.not. quick%done(i)) then
            call update_stress(rock, softening(i), old(:, i), trial(:, i), point(i), sigma(:, i), &
               dep(:, i), dep_compressive(:, i), active(i), code(i))
            if (active(i) /= 0) call strength_of_band(rock, softening(i), point(i)%ep_eff, &
               strength(1, i), strength(2, i))
            cycle
         end if
         point(i)%axis = axis(i, :)
         active(i) = quick%active(i)
         if (active(i) == 0) cycle
         point(i)%ep_eff = quick%e(i)
         strength(:, i) = [quick%sin_phi(i), quick%c_cos_phi(i)]
         call apply_flow(rock, softening(i), trial(:, i), quick%dep(i, :), point(i), sigma(:, i), &
            dep(:, i))
         dep_compressive(:, i) = dep(:, i)
      end do
   end subroutine update_pack

   !> One point of a rock that yields, by the general search.
   pure subroutine update_stress(rock, softening, old, trial, point, sigma, dep, &
      dep_compressive, active, code)
      type(rock_type), intent(in) :: rock
      real(wp), intent(in) :: softening
      real(wp), intent(in) :: old(4)
      real(wp), intent(in) :: trial(4)
      type(point_type), intent(inout) :: point
      real(wp), intent(inout) :: sigma(4)
      real(wp), intent(inout) :: dep(4)
      real(wp), intent(inout) :: dep_compressive(4)
      integer, intent(inout) :: active
      integer, intent(inout) :: code

      if (regularises(rock)) then
         call update_in_band(rock, softening, old, trial, point, sigma, dep, dep_compressive, &
            active, code)
      else
         call update_by_table(rock, softening, old, trial, point, sigma, dep, dep_compressive, &
            active, code)
      end if
   end subroutine update_stress

   !> The same with the tables that hold in a band of the width that `softening` stands for.
   pure subroutine update_in_band(rock, softening, old, trial, point, sigma, dep, &
      dep_compressive, active, code)
      type(rock_type), intent(in) :: rock
      real(wp), intent(in) :: softening
      real(wp), intent(in) :: old(4)
      real(wp), intent(in) :: trial(4)
      type(point_type), intent(inout) :: point
      real(wp), intent(inout) :: sigma(4)
      real(wp), intent(inout) :: dep(4)
      real(wp), intent(inout) :: dep_compressive(4)
      integer, intent(inout) :: active
      integer, intent(inout) :: code

      type(rock_type) :: own

      call rock_of_band(rock, softening, own)
      call update_by_table(own, softening, old, trial, point, sigma, dep, dep_compressive, &
         active, code)
   end subroutine update_in_band

   !> One return, in ever smaller parts until it succeeds.
   pure subroutine update_by_table(rock, softening, old, trial, point, sigma, dep, &
      dep_compressive, active, code)
      type(rock_type), intent(in) :: rock
      real(wp), intent(in) :: softening
      real(wp), intent(in) :: old(4)
      real(wp), intent(in) :: trial(4)
      type(point_type), intent(inout) :: point
      real(wp), intent(inout) :: sigma(4)
      real(wp), intent(inout) :: dep(4)
      real(wp), intent(inout) :: dep_compressive(4)
      integer, intent(inout) :: active
      integer, intent(inout) :: code

      integer :: halving

      call take_step(rock, softening, trial, point, sigma, dep, dep_compressive, active, code)
      do halving = 1, max_halvings
         if (code == ok) return
         call take_parts(rock, softening, old, trial, 2**halving, point, sigma, dep, &
            dep_compressive, active, code)
      end do
      if (code /= ok) sigma = old
   end subroutine update_by_table

   !> sin(phi) and c cos(phi) [Pa] of a band: all that a yield check needs.
   pure subroutine strength_of_band(rock, softening, ep_eff, sin_phi, c_cos_phi)
      type(rock_type), intent(in) :: rock
      real(wp), intent(in) :: softening   !! H, not positive [Pa]
      real(wp), intent(in) :: ep_eff      !! effective plastic strain [-]
      real(wp), intent(out) :: sin_phi    !! [-]
      real(wp), intent(out) :: c_cos_phi  !! [Pa]

      call strength_coefficients(rock, table_strain(rock, softening, ep_eff), sin_phi, c_cos_phi)
   end subroutine strength_of_band

   !> One return, without sub-steps.
   pure subroutine take_step(rock, softening, trial, point, sigma, dep, dep_compressive, &
      active, code)
      type(rock_type), intent(in) :: rock
      real(wp), intent(in) :: softening
      real(wp), intent(in) :: trial(4)
      type(point_type), intent(inout) :: point
      real(wp), intent(out) :: sigma(4)
      real(wp), intent(out) :: dep(4)
      real(wp), intent(out) :: dep_compressive(4)
      integer, intent(out) :: active
      integer, intent(out) :: code

      real(wp) :: axis(2), d(3), normal(3), x(3)

      axis = point%axis
      call follow_axes(trial, axis)
      normal = normal_components(trial, axis)
      call return_to_surface(rock, softening, normal, point%ft, point%ep_eff, d, x, active, code)
      sigma = trial
      dep = 0.0_wp
      dep_compressive = 0.0_wp
      if (code /= ok) return
      point%axis = axis
      if (active == 0) return

      call apply_flow(rock, softening, trial, d, point, sigma, dep)
      dep_compressive = tensor_from_axes(x, axis)
      dep_compressive(4) = 2.0_wp*dep_compressive(4)
   end subroutine take_step

   !> Stress, strengths and crack after a flow along the axes of the point.
   pure subroutine apply_flow(rock, softening, trial, d, point, sigma, dep)
      type(rock_type), intent(in) :: rock
      real(wp), intent(in) :: softening
      real(wp), intent(in) :: trial(4)
      real(wp), intent(in) :: d(3)             !! inelastic strain increments [-]
      type(point_type), intent(inout) :: point !! whose axes have followed the stress
      real(wp), intent(out) :: sigma(4)
      real(wp), intent(out) :: dep(4)          !! engineering shear

      real(wp) :: ft(3), volume

      dep = tensor_from_axes(d, point%axis)
      volume = rock%lame*(dep(1) + dep(2) + dep(3))
      sigma = trial - 2.0_wp*rock%shear*dep - [volume, volume, volume, 0.0_wp]
      dep(4) = 2.0_wp*dep(4)

      ft = softened_strength(point%ft, softening, d)
      call turn_crack((point%ft(:2) - ft(:2))/rock%tensile_strength, point%axis, point%crack)
      point%ft = ft
      point%opening = point%opening + max(d, 0.0_wp)
   end subroutine apply_flow

   !> The step in `parts` equal pieces; the state moves only if every piece returns.
   pure subroutine take_parts(rock, softening, old, trial, parts, point, sigma, dep, &
      dep_compressive, active, code)
      type(rock_type), intent(in) :: rock
      real(wp), intent(in) :: softening
      real(wp), intent(in) :: old(4)
      real(wp), intent(in) :: trial(4)
      integer, intent(in) :: parts
      type(point_type), intent(inout) :: point
      real(wp), intent(out) :: sigma(4)
      real(wp), intent(out) :: dep(4)
      real(wp), intent(out) :: dep_compressive(4)
      integer, intent(out) :: active
      integer, intent(out) :: code

      type(point_type) :: moving
      integer :: part, part_active
      real(wp) :: now(4), part_dep(4), part_compressive(4), part_trial(4), volume

      moving = point
      now = old
      dep = 0.0_wp
      dep_compressive = 0.0_wp
      active = 0
      code = no_return_map
      do part = 1, parts
         part_trial = now + (trial - old)/real(parts, wp)
         call take_step(rock, softening, part_trial, moving, now, part_dep, part_compressive, &
            part_active, code)
         if (code /= ok) exit
         dep = dep + part_dep
         dep_compressive = dep_compressive + part_compressive
         active = ior(active, part_active)
      end do
      if (code == ok) then
         volume = rock%lame*(dep(1) + dep(2) + dep(3))
         sigma = trial - 2.0_wp*rock%shear*[dep(1), dep(2), dep(3), 0.5_wp*dep(4)] &
            - [volume, volume, volume, 0.0_wp]
         point = moving
         active = ibset(active, substep_bit)
      else
         sigma = old
         dep = 0.0_wp
         dep_compressive = 0.0_wp
         active = 0
      end if
   end subroutine take_parts

end module lithofrac_material_stress_update
