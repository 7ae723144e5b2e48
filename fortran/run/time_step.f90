!> Exact critical step of each element.
!>
!> The critical step of central differences is 2/omega with omega the highest frequency of the
!> mesh, and no mesh has a higher one than its stiffest free element (Irons and Treharne). It
!> is found exactly: omega^2 is the largest eigenvalue of D^1/2 B M^-1 B^T D^1/2 V (4 by 4).
module lithofrac_run_time_step
   use lithofrac_base_kinds, only: wp
   use lithofrac_material_rock, only: rock_type
   use lithofrac_mechanics_chunks, only: chunks_type
   use lithofrac_mechanics_lumped_mass, only: corner_masses
   use lithofrac_mesh_mesh, only: mesh_type
   implicit none
   private

   public :: critical_step

contains

   !> 2/omega of one element on its own [s]; follows the reference geometry.
   function critical_step(mesh, chunks, element, rock) result(dt)
      type(mesh_type), intent(in) :: mesh
      type(chunks_type), intent(in) :: chunks
      integer, intent(in) :: element
      type(rock_type), intent(in) :: rock
      real(wp) :: dt

      real(wp) :: b(4, 6), root(4, 4), a(4, 4), mass(3), root_shear
      integer :: i

      mass = corner_masses(mesh, element, rock%density, chunks%axisymmetric)
      associate (lane => chunks%lane_of(element), chunk => chunks%chunk_of(element))
         b = strain_operator(chunks%gradient(lane, :, chunk))
         if (chunks%axisymmetric) b(3, 1::2) = chunks%hoop(lane, chunk)
         do i = 1, 3
            b(:, 2*i - 1:2*i) = b(:, 2*i - 1:2*i)*sqrt(chunks%volume(lane, chunk)/mass(i))
         end do
      end associate
      root_shear = sqrt(2.0_wp*rock%shear)
      root = 0.0_wp
      root(:3, :3) = (sqrt(2.0_wp*rock%shear + 3.0_wp*rock%lame) - root_shear)/3.0_wp
      do i = 1, 3
         root(i, i) = root(i, i) + root_shear
      end do
      root(4, 4) = sqrt(rock%shear)
      b = matmul(root, b)
      a = matmul(b, transpose(b))
      dt = 2.0_wp/sqrt(largest_eigenvalue(a))
   end function critical_step

   !> Strain (xx, yy, zz, engineering xy) of the six corner displacements x1, y1, x2, ...
   pure function strain_operator(gradient) result(b)
      real(wp), intent(in) :: gradient(4)   !! dN2/dX, dN2/dY, dN3/dX, dN3/dY [1/m]
      real(wp) :: b(4, 6)

      real(wp) :: dx(3), dy(3)

      dx = [-gradient(1) - gradient(3), gradient(1), gradient(3)]
      dy = [-gradient(2) - gradient(4), gradient(2), gradient(4)]
      b = 0.0_wp
      b(1, 1::2) = dx
      b(2, 2::2) = dy
      b(4, 1::2) = dy
      b(4, 2::2) = dx
   end function strain_operator

   !> Largest eigenvalue of a symmetric 4 by 4 matrix, by cyclic Jacobi rotations.
   pure function largest_eigenvalue(matrix) result(value)
      real(wp), intent(in) :: matrix(4, 4)
      real(wp) :: value

      real(wp) :: a(4, 4), ratio, t, c, s, row(4), off
      integer :: sweep, p, q

      a = matrix
      do sweep = 1, 30
         off = 0.0_wp
         do p = 1, 3
            do q = p + 1, 4
               off = max(off, abs(a(p, q)))
               if (abs(a(p, q)) <= tiny(off)) cycle
               ratio = (a(q, q) - a(p, p))/(2.0_wp*a(p, q))
               t = sign(1.0_wp, ratio)/(abs(ratio) + sqrt(1.0_wp + ratio*ratio))
               c = 1.0_wp/sqrt(1.0_wp + t*t)
               s = t*c
               row = a(p, :)
               a(p, :) = c*row - s*a(q, :)
               a(q, :) = s*row + c*a(q, :)
               row = a(:, p)
               a(:, p) = c*row - s*a(:, q)
               a(:, q) = s*row + c*a(:, q)
            end do
         end do
         if (off <= 1.0e-16_wp*max(a(1, 1), a(2, 2), a(3, 3), a(4, 4))) exit
      end do
      value = max(a(1, 1), a(2, 2), a(3, 3), a(4, 4))
   end function largest_eigenvalue

end module lithofrac_run_time_step
