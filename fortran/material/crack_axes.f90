!> Which tensile strength belongs to which principal axis, and where the crack points
!> (Klerck, Sellers & Owen 2004, section 2.3 and eq. 13).
!>
!> Axes travel as (cos 2 theta, sin 2 theta). This module knows nothing of yielding.
module lithofrac_material_crack_axes
   use lithofrac_base_kinds, only: wp
   use lithofrac_math_principal, only: mohr_circle
   implicit none
   private

   public :: follow_axes, turn_crack

   real(wp), parameter :: equality = 1.0e-12_wp  !! of the stress: equal principal values

contains

   !> Turn the strength axes to the principal axes of `stress`.
   !>
   !> The first axis becomes the principal axis nearest to it modulo 180 degrees. It turns by
   !> 45 degrees at most, so a strength keeps its place in the list: a stress field that turns
   !> less keeps its strengths, one that turns further meets them swapped. Equal principal
   !> stresses have no axes of their own: the old axes stay. A turn of exactly 45 degrees
   !> takes the axis of the larger stress.
   pure subroutine follow_axes(stress, axis)
      real(wp), intent(in) :: stress(4)     !! xx, yy, zz, xy [Pa]
      real(wp), intent(inout) :: axis(2)    !! first strength axis

      real(wp) :: centre, radius, larger(2), scale

      scale = max(abs(stress(1)), abs(stress(2)), abs(stress(3)))
      call mohr_circle(stress, equality*scale, axis, centre, radius, larger)
      if (larger(1)*axis(1) + larger(2)*axis(2) < 0.0_wp) larger = -larger
      axis = larger
   end subroutine follow_axes

   !> Add the damage of one step to the average crack direction (eq. 13).
   !>
   !> The sum of damage increments times doubled directions is the deviator of the damage
   !> tensor; its direction is the normal of the crack band. No damage, no turn.
   pure subroutine turn_crack(damage, axis, crack)
      real(wp), intent(in) :: damage(2)    !! loss of ft/ft0 along the axis and at 90 degrees [-]
      real(wp), intent(in) :: axis(2)
      real(wp), intent(inout) :: crack(2)  !! sum over the history [-]

      crack = crack + (damage(1) - damage(2))*axis
   end subroutine turn_crack

end module lithofrac_material_crack_axes
