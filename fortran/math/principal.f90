!> Principal values and directions of a plane stress tensor.
!>
!> Directions travel as (cos 2 theta, sin 2 theta): they have period pi, so the
!> doubled angle is their natural coordinate and no arc function is needed.
!> This module knows nothing of materials.
module lithofrac_math_principal
   use lithofrac_base_kinds, only: wp
   implicit none
   private

   public :: mohr_circle, normal_components, tensor_from_axes

contains

   !> Centre, radius and axis of the in-plane Mohr circle of (xx, yy, zz, xy).
   !>
   !> The principal values are `centre + radius` along `axis` and `centre - radius` at
   !> 90 degrees to it. A circle without radius has no axis: `fallback` is handed back.
   pure subroutine mohr_circle(tensor, equality, fallback, centre, radius, axis)
      real(wp), intent(in) :: tensor(4)    !! xx, yy, zz, xy; tensor shear, any unit
      real(wp), intent(in) :: equality     !! radius below which both values count as equal
      real(wp), intent(in) :: fallback(2)  !! axis for equal values
      real(wp), intent(out) :: centre
      real(wp), intent(out) :: radius
      real(wp), intent(out) :: axis(2)     !! cos 2 theta, sin 2 theta of the larger value

      real(wp) :: half

      centre = 0.5_wp*(tensor(1) + tensor(2))
      half = 0.5_wp*(tensor(1) - tensor(2))
      radius = sqrt(half*half + tensor(4)*tensor(4))
      axis = fallback
      if (radius > equality) axis = [half, tensor(4)]/radius
   end subroutine mohr_circle

   !> Normal components of a tensor along `axis`, at 90 degrees to it, and along z.
   pure function normal_components(tensor, axis) result(normal)
      real(wp), intent(in) :: tensor(4)  !! xx, yy, zz, xy; tensor shear
      real(wp), intent(in) :: axis(2)    !! cos 2 theta, sin 2 theta
      real(wp) :: normal(3)

      real(wp) :: centre, along

      centre = 0.5_wp*(tensor(1) + tensor(2))
      along = 0.5_wp*(tensor(1) - tensor(2))*axis(1) + tensor(4)*axis(2)
      normal = [centre + along, centre - along, tensor(3)]
   end function normal_components

   !> Tensor (xx, yy, zz, tensor shear xy) with the given values along the axes.
   pure function tensor_from_axes(values, axis) result(tensor)
      real(wp), intent(in) :: values(3)  !! along `axis`, at 90 degrees to it, along z
      real(wp), intent(in) :: axis(2)    !! cos 2 theta, sin 2 theta
      real(wp) :: tensor(4)

      real(wp) :: centre, half

      centre = 0.5_wp*(values(1) + values(2))
      half = 0.5_wp*(values(1) - values(2))
      tensor = [centre + half*axis(1), centre - half*axis(1), values(3), half*axis(2)]
   end function tensor_from_axes

end module lithofrac_math_principal
