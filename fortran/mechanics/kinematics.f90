!> Chunk kernels of the constant-strain triangle: gather, strain, stress, nodal force, scatter.
!>
!> Green-Naghdi as small strain in the unrotated frame, work-conjugate. With F = R U on the
!> reference geometry the strain is U - I, the stress T comes from the material, and
!>
!>    P = R (T - (b/tr U) J),   b = T : (J U),   J = [[0, -1], [1, 0]],
!>
!> so that P : dF = T : dU exactly: no energy drifts in closed cycles of strain and rotation.
!> Components: xx, yy, zz, xy; shear strain is engineering (Klerck 2004, section 2.1).
!>
!> Fields of nodes come with their shape: (:, :) would have a stride that the compiler must
!> multiply by, node for node, which takes a tenth of a step.
module lithofrac_mechanics_kinematics
   use lithofrac_base_kinds, only: wp
   use lithofrac_material_rock, only: rock_type
   use lithofrac_mechanics_chunks, only: width
   implicit none
   private

   public :: area_ratios, elastic_forces, elastic_stress, gather, gather_previous, hoop_strain
   public :: nodal_forces, scatter, scatter_hoop, strains, virgin_forces

contains

   !> Displacements of corners 2 and 3 relative to corner 1.
   pure subroutine gather(node, n_nodes, u, du)
      integer, intent(in) :: node(width, 3)
      integer, intent(in) :: n_nodes
      real(wp), intent(in) :: u(2, n_nodes)         !! displacement [m]
      real(wp), intent(out) :: du(width, 4)         !! x2, y2, x3, y3 relative to corner 1 [m]

      integer :: i

      do i = 1, width
         du(i, 1) = u(1, node(i, 2)) - u(1, node(i, 1))
         du(i, 2) = u(2, node(i, 2)) - u(2, node(i, 1))
         du(i, 3) = u(1, node(i, 3)) - u(1, node(i, 1))
         du(i, 4) = u(2, node(i, 3)) - u(2, node(i, 1))
      end do
   end subroutine gather

   !> The same for one element, one step earlier: from u - dt v.
   pure subroutine gather_previous(corner, u, v, dt, du)
      integer, intent(in) :: corner(3)
      real(wp), intent(in), contiguous :: u(:, :)   !! (2, n_nodes) displacement now [m]
      real(wp), intent(in), contiguous :: v(:, :)   !! (2, n_nodes) velocity that led to it [m/s]
      real(wp), intent(in) :: dt                    !! step that led to it [s]
      real(wp), intent(out) :: du(4)                !! x2, y2, x3, y3 relative to corner 1 [m]

      real(wp) :: before(2, 3)

      before = u(:, corner) - dt*v(:, corner)
      du(1:2) = before(:, 2) - before(:, 1)
      du(3:4) = before(:, 3) - before(:, 1)
   end subroutine gather_previous

   !> In-plane strain U - I and rotation R of the polar decomposition F = R U.
   pure subroutine strains(n, gradient, du, strain, rotation)
      integer, intent(in) :: n                      !! lanes
      real(wp), intent(in) :: gradient(n, 4)        !! of the shape functions [1/m]
      real(wp), intent(in) :: du(n, 4)              !! [m]
      real(wp), intent(inout) :: strain(n, 4)       !! xx, yy, xy are set; zz is left alone
      real(wp), intent(out) :: rotation(n, 3)       !! cos, sin, 1/tr U

      integer :: i

      !$omp simd
      do i = 1, n
         call stretch(gradient(i, 1), gradient(i, 2), gradient(i, 3), gradient(i, 4), du(i, 1), &
            du(i, 2), du(i, 3), du(i, 4), strain(i, 1), strain(i, 2), strain(i, 4), &
            rotation(i, 1), rotation(i, 2), rotation(i, 3))
      end do
   end subroutine strains

   !> det F: area of now over that of the reference.
   pure subroutine area_ratios(gradient, du, ratio)
      real(wp), intent(in) :: gradient(width, 4)    !! of the shape functions [1/m]
      real(wp), intent(in) :: du(width, 4)          !! [m]
      real(wp), intent(out) :: ratio(width)

      integer :: i
      real(wp) :: h11, h12, h21, h22

      do i = 1, width
         h11 = du(i, 1)*gradient(i, 1) + du(i, 3)*gradient(i, 3)
         h12 = du(i, 1)*gradient(i, 2) + du(i, 3)*gradient(i, 4)
         h21 = du(i, 2)*gradient(i, 1) + du(i, 4)*gradient(i, 3)
         h22 = du(i, 2)*gradient(i, 2) + du(i, 4)*gradient(i, 4)
         ratio(i) = (1.0_wp + h11)*(1.0_wp + h22) - h12*h21
      end do
   end subroutine area_ratios

   !> Hoop strain of axisymmetry, from the mean radius of the element (no lock-up at the axis).
   pure subroutine hoop_strain(node, n_nodes, u, hoop, strain_zz)
      integer, intent(in) :: node(width, 3)
      integer, intent(in) :: n_nodes
      real(wp), intent(in) :: u(2, n_nodes)         !! [m]
      real(wp), intent(in) :: hoop(width)           !! 1/(3 mean radius) [1/m]
      real(wp), intent(out) :: strain_zz(width)

      integer :: i

      do i = 1, width
         strain_zz(i) = hoop(i)*(u(1, node(i, 1)) + u(1, node(i, 2)) + u(1, node(i, 3)))
      end do
   end subroutine hoop_strain

   !> Isotropic elastic stress of the elastic strain.
   pure subroutine elastic_stress(n, lame, shear, strain, inelastic, stress)
      integer, intent(in) :: n
      real(wp), intent(in) :: lame                  !! [Pa]
      real(wp), intent(in) :: shear                 !! [Pa]
      real(wp), intent(in) :: strain(n, 4)
      real(wp), intent(in) :: inelastic(n, 4)       !! inelastic strain
      real(wp), intent(out) :: stress(n, 4)         !! [Pa]

      integer :: i

      !$omp simd
      do i = 1, n
         call hooke(lame, shear, strain(i, 1) - inelastic(i, 1), strain(i, 2) - inelastic(i, 2), &
            strain(i, 3) - inelastic(i, 3), strain(i, 4) - inelastic(i, 4), stress(i, 1), &
            stress(i, 2), stress(i, 3), stress(i, 4))
      end do
   end subroutine elastic_stress

   !> Internal forces on corners 2 and 3; corner 1 takes the opposite of their sum.
   pure subroutine nodal_forces(n, gradient, volume, strain, rotation, stress, force)
      integer, intent(in) :: n                      !! lanes
      real(wp), intent(in) :: gradient(n, 4)        !! [1/m]
      real(wp), intent(in) :: volume(n)             !! [m3] per metre or per radian
      real(wp), intent(in) :: strain(n, 4)
      real(wp), intent(in) :: rotation(n, 3)        !! cos, sin, 1/tr U
      real(wp), intent(in) :: stress(n, 4)          !! unrotated [Pa]
      real(wp), intent(out) :: force(n, 4)          !! x2, y2, x3, y3 [N] per metre or per radian

      integer :: i

      !$omp simd
      do i = 1, n
         call corner_forces(gradient(i, 1), gradient(i, 2), gradient(i, 3), gradient(i, 4), &
            volume(i), strain(i, 1), strain(i, 2), strain(i, 4), rotation(i, 1), rotation(i, 2), &
            rotation(i, 3), stress(i, 1), stress(i, 2), stress(i, 4), force(i, 1), force(i, 2), &
            force(i, 3), force(i, 4))
      end do
   end subroutine nodal_forces

   !> All of it in one pass, for a chunk that cannot yield.
   pure subroutine elastic_forces(rock, gradient, volume, du, strain_zz, force, stress_zz)
      type(rock_type), intent(in) :: rock
      real(wp), intent(in) :: gradient(width, 4)    !! [1/m]
      real(wp), intent(in) :: volume(width)         !! [m3] per metre or per radian
      real(wp), intent(in) :: du(width, 4)          !! x2, y2, x3, y3 relative to corner 1 [m]
      real(wp), intent(in) :: strain_zz(width)
      real(wp), intent(out) :: force(width, 4)      !! x2, y2, x3, y3 [N] per metre or per radian
      real(wp), intent(out) :: stress_zz(width)     !! [Pa]

      integer :: i
      real(wp) :: xx, yy, xy, c, s, r, sxx, syy, szz, sxy

      !$omp simd private(xx, yy, xy, c, s, r, sxx, syy, szz, sxy)
      do i = 1, width
         call stretch(gradient(i, 1), gradient(i, 2), gradient(i, 3), gradient(i, 4), du(i, 1), &
            du(i, 2), du(i, 3), du(i, 4), xx, yy, xy, c, s, r)
         call hooke(rock%lame, rock%shear, xx, yy, strain_zz(i), xy, sxx, syy, szz, sxy)
         call corner_forces(gradient(i, 1), gradient(i, 2), gradient(i, 3), gradient(i, 4), &
            volume(i), xx, yy, xy, c, s, r, sxx, syy, sxy, force(i, 1), force(i, 2), force(i, 3), &
            force(i, 4))
         stress_zz(i) = szz
      end do
   end subroutine elastic_forces

   !> The same for a chunk that has never yielded; and whether that stays so.
   !>
   !> `inside` is true only when every stress is within the virgin strength. The check takes no
   !> root, so that a stress on the very edge may be taken for one beyond it, never the reverse.
   pure subroutine virgin_forces(rock, gradient, volume, du, strain_zz, force, stress_zz, inside)
      type(rock_type), intent(in) :: rock
      real(wp), intent(in) :: gradient(width, 4)    !! [1/m]
      real(wp), intent(in) :: volume(width)         !! [m3] per metre or per radian
      real(wp), intent(in) :: du(width, 4)          !! x2, y2, x3, y3 relative to corner 1 [m]
      real(wp), intent(in) :: strain_zz(width)
      real(wp), intent(out) :: force(width, 4)      !! x2, y2, x3, y3 [N] per metre or per radian
      real(wp), intent(out) :: stress_zz(width)     !! [Pa]
      logical, intent(out) :: inside

      integer :: i
      real(wp) :: xx, yy, xy, c, s, r, sxx, syy, szz, sxy, worst

      worst = -huge(worst)
      !$omp simd private(xx, yy, xy, c, s, r, sxx, syy, szz, sxy) reduction(max:worst)
      do i = 1, width
         call stretch(gradient(i, 1), gradient(i, 2), gradient(i, 3), gradient(i, 4), du(i, 1), &
            du(i, 2), du(i, 3), du(i, 4), xx, yy, xy, c, s, r)
         call hooke(rock%lame, rock%shear, xx, yy, strain_zz(i), xy, sxx, syy, szz, sxy)
         worst = max(worst, beyond(sxx, syy, szz, sxy, rock%sin_phi0, rock%c_cos_phi0, &
            rock%tensile_strength))
         call corner_forces(gradient(i, 1), gradient(i, 2), gradient(i, 3), gradient(i, 4), &
            volume(i), xx, yy, xy, c, s, r, sxx, syy, sxy, force(i, 1), force(i, 2), force(i, 3), &
            force(i, 4))
         stress_zz(i) = szz
      end do
      inside = worst < 0.0_wp
   end subroutine virgin_forces

   !> Below zero only where a stress is within Mohr-Coulomb and below the tensile strength [Pa2].
   !>
   !> With in-plane principal stresses mean +- radius each plane bounds the radius from above.
   elemental function beyond(xx, yy, zz, xy, sin_phi, c_cos_phi, ft) result(excess)
      real(wp), intent(in) :: xx, yy, zz, xy   !! [Pa]
      real(wp), intent(in) :: sin_phi
      real(wp), intent(in) :: c_cos_phi        !! [Pa]
      real(wp), intent(in) :: ft               !! [Pa]
      real(wp) :: excess

      real(wp) :: mean, half, room

      mean = 0.5_wp*(xx + yy)
      half = 0.5_wp*(xx - yy)
      room = min(c_cos_phi - mean*sin_phi, ft - mean, &
         (2.0_wp*c_cos_phi + zz*(1.0_wp - sin_phi))*(1.0_wp/(1.0_wp + sin_phi)) - mean, &
         (2.0_wp*c_cos_phi - zz*(1.0_wp + sin_phi))*(1.0_wp/(1.0_wp - sin_phi)) + mean)
      room = merge(max(room, 0.0_wp), 0.0_wp, zz < ft)
      excess = half*half + xy*xy - room*room
   end function beyond

   !> Polar decomposition of one element: strain U - I, and R as cos, sin and 1/tr U.
   pure subroutine stretch(g2x, g2y, g3x, g3y, u2, v2, u3, v3, xx, yy, xy, c, s, r)
      real(wp), intent(in) :: g2x, g2y, g3x, g3y   !! gradients of the shape functions [1/m]
      real(wp), intent(in) :: u2, v2, u3, v3       !! displacements relative to corner 1 [m]
      real(wp), intent(out) :: xx, yy, xy          !! engineering shear
      real(wp), intent(out) :: c, s, r

      real(wp) :: h11, h12, h21, h22, t, versine

      h11 = u2*g2x + u3*g3x
      h12 = u2*g2y + u3*g3y
      h21 = v2*g2x + v3*g3x
      h22 = v2*g2y + v3*g3y
      c = 2.0_wp + h11 + h22
      t = h21 - h12
      r = 1.0_wp/sqrt(c*c + t*t)
      c = c*r
      s = t*r
      ! 1 - cos without cancellation, so that small strains keep their digits
      versine = merge(s*s/(1.0_wp + abs(c)), 1.0_wp - c, c > 0.0_wp)
      xx = h11 - versine*(1.0_wp + h11) + s*h21
      yy = h22 - versine*(1.0_wp + h22) - s*h12
      xy = c*(h12 + h21) + s*(h22 - h11)
   end subroutine stretch

   !> Isotropic elastic stress of one element [Pa]; engineering shear.
   pure subroutine hooke(lame, shear, xx, yy, zz, xy, sxx, syy, szz, sxy)
      real(wp), intent(in) :: lame, shear          !! [Pa]
      real(wp), intent(in) :: xx, yy, zz, xy       !! elastic strain
      real(wp), intent(out) :: sxx, syy, szz, sxy  !! [Pa]

      real(wp) :: pressure

      pressure = lame*(xx + yy + zz)
      sxx = pressure + 2.0_wp*shear*xx
      syy = pressure + 2.0_wp*shear*yy
      szz = pressure + 2.0_wp*shear*zz
      sxy = shear*xy
   end subroutine hooke

   !> Internal forces of one element on corners 2 and 3 [N] per metre or per radian.
   pure subroutine corner_forces(g2x, g2y, g3x, g3y, volume, xx, yy, xy, c, s, r, sxx, syy, sxy, &
      f2x, f2y, f3x, f3y)
      real(wp), intent(in) :: g2x, g2y, g3x, g3y   !! [1/m]
      real(wp), intent(in) :: volume               !! [m3] per metre or per radian
      real(wp), intent(in) :: xx, yy, xy           !! strain, engineering shear
      real(wp), intent(in) :: c, s, r              !! rotation, see `stretch`
      real(wp), intent(in) :: sxx, syy, sxy        !! unrotated stress [Pa]
      real(wp), intent(out) :: f2x, f2y, f3x, f3y

      real(wp) :: b, s11, s12, s21, s22, p11, p12, p21, p22

      b = r*(0.5_wp*(syy - sxx)*xy + sxy*(xx - yy))
      s11 = volume*sxx
      s22 = volume*syy
      s12 = volume*(sxy + b)
      s21 = volume*(sxy - b)
      p11 = c*s11 - s*s21
      p12 = c*s12 - s*s22
      p21 = s*s11 + c*s21
      p22 = s*s12 + c*s22
      f2x = p11*g2x + p12*g2y
      f2y = p21*g2x + p22*g2y
      f3x = p11*g3x + p12*g3y
      f3y = p21*g3x + p22*g3y
   end subroutine corner_forces

   !> Add the forces of a chunk to the buffer of its block, in the order of its elements.
   pure subroutine scatter(place, force, n_places, buffer)
      integer, intent(in) :: place(width, 3)             !! of the corners in `buffer`
      real(wp), intent(in) :: force(width, 4)            !! x2, y2, x3, y3 [N]
      integer, intent(in) :: n_places
      real(wp), intent(inout) :: buffer(2, n_places)     !! [N]

      integer :: i, a, b, c

      do i = 1, width
         a = place(i, 1)
         b = place(i, 2)
         c = place(i, 3)
         buffer(1, b) = buffer(1, b) + force(i, 1)
         buffer(2, b) = buffer(2, b) + force(i, 2)
         buffer(1, c) = buffer(1, c) + force(i, 3)
         buffer(2, c) = buffer(2, c) + force(i, 4)
         buffer(1, a) = buffer(1, a) - (force(i, 1) + force(i, 3))
         buffer(2, a) = buffer(2, a) - (force(i, 2) + force(i, 4))
      end do
   end subroutine scatter

   !> Radial force of the hoop stress, shared by the three corners.
   pure subroutine scatter_hoop(place, hoop, volume, stress_zz, n_places, buffer)
      integer, intent(in) :: place(width, 3)
      real(wp), intent(in) :: hoop(width)               !! 1/(3 mean radius) [1/m]
      real(wp), intent(in) :: volume(width)             !! [m3/rad]
      real(wp), intent(in) :: stress_zz(width)          !! hoop stress [Pa]
      integer, intent(in) :: n_places
      real(wp), intent(inout) :: buffer(2, n_places)

      integer :: i
      real(wp) :: share

      do i = 1, width
         share = hoop(i)*volume(i)*stress_zz(i)
         buffer(1, place(i, 1)) = buffer(1, place(i, 1)) + share
         buffer(1, place(i, 2)) = buffer(1, place(i, 2)) + share
         buffer(1, place(i, 3)) = buffer(1, place(i, 3)) + share
      end do
   end subroutine scatter_hoop

end module lithofrac_mechanics_kinematics
