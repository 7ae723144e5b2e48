!> Lumped mass (eq. 2): a third of the element, weighted by the radius in axisymmetry.
module lithofrac_mechanics_lumped_mass
   use lithofrac_base_kinds, only: wp
   use lithofrac_mesh_mesh, only: mesh_type, triangle_area
   implicit none
   private

   public :: corner_masses

contains

   !> Masses of the three corners of an element [kg], per metre of depth or per radian.
   pure function corner_masses(mesh, element, density, axisymmetric) result(mass)
      type(mesh_type), intent(in) :: mesh
      integer, intent(in) :: element
      real(wp), intent(in) :: density        !! [kg/m3]
      logical, intent(in) :: axisymmetric
      real(wp) :: mass(3)

      real(wp) :: area

      associate (corner => mesh%triangles(:, element))
         area = triangle_area(mesh%nodes(:, corner(1)), mesh%nodes(:, corner(2)), &
            mesh%nodes(:, corner(3)))
         if (axisymmetric) then
            mass = density*area*(mesh%nodes(1, corner) + sum(mesh%nodes(1, corner)))/12.0_wp
         else
            mass = density*area/3.0_wp
         end if
      end associate
   end function corner_masses

end module lithofrac_mechanics_lumped_mass
