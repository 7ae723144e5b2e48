!> Single kernels of the material point, for tests, for calibration and for the bench.
!> Batches run over the last index. Only intrinsic types and explicit shapes here: this is a
!> file that f2py reads. Every routine ends with `code`, `message`.
module kernels_material
   use, intrinsic :: iso_c_binding, only: c_double, c_int
   use lithofrac_base_status, only: ok, status_type
   use lithofrac_material_crack_axes, only: follow_axes, turn_crack
   use lithofrac_material_mohr_coulomb, only: strength_coefficients
   use lithofrac_material_pyramid_return, only: pack, pyramid_return_type, return_to_pyramid
   use lithofrac_material_return_map, only: return_to_surface
   use lithofrac_material_rock, only: new_rock, rock_type
   use lithofrac_material_stress_update, only: point_type, update_pack
   use lithofrac_material_table, only: new_table, table_type, value_and_slope
   use lithofrac_material_tension_planes, only: band_width, band_width_limit, &
      softened_strength, softening_modulus
   use lithofrac_math_principal, only: mohr_circle, normal_components, tensor_from_axes
   implicit none
   private

   public :: principal_axes, rotate_axes, table_eval, rock_scales, strength_eval, planes_soften
   public :: axes_follow, crack_turn, return_principal, point_step

contains

   !> Centre, radius and axis of the Mohr circles of `tensors`, and the tensors put together
   !> again from them.
   subroutine principal_axes(tensors, n, equality, fallback, centres, radii, axes, again, &
      code, message)
      integer(c_int), intent(in) :: n
      real(c_double), intent(in) :: tensors(4, n)
      real(c_double), intent(in) :: equality
      real(c_double), intent(in) :: fallback(2)
      real(c_double), intent(out) :: centres(n)
      real(c_double), intent(out) :: radii(n)
      real(c_double), intent(out) :: axes(2, n)
      real(c_double), intent(out) :: again(4, n)
      integer(c_int), intent(out) :: code
      character(len=256), intent(out) :: message

      integer :: i

      do i = 1, n
         call mohr_circle(tensors(:, i), equality, fallback, centres(i), radii(i), axes(:, i))
         again(:, i) = tensor_from_axes([centres(i) + radii(i), centres(i) - radii(i), &
            tensors(3, i)], axes(:, i))
      end do
      code = ok
      message = ""
   end subroutine principal_axes

   !> Normal components of `tensors` along given axes.
   subroutine rotate_axes(tensors, axes, n, normals, code, message)
      integer(c_int), intent(in) :: n
      real(c_double), intent(in) :: tensors(4, n)
      real(c_double), intent(in) :: axes(2, n)
      real(c_double), intent(out) :: normals(3, n)
      integer(c_int), intent(out) :: code
      character(len=256), intent(out) :: message

      integer :: i

      do i = 1, n
         normals(:, i) = normal_components(tensors(:, i), axes(:, i))
      end do
      code = ok
      message = ""
   end subroutine rotate_axes

   !> Value and slope of the table (x, y) at `at`.
   subroutine table_eval(x, y, n, at, m, values, slopes, code, message)
      integer(c_int), intent(in) :: n
      integer(c_int), intent(in) :: m
      real(c_double), intent(in) :: x(n)
      real(c_double), intent(in) :: y(n)
      real(c_double), intent(in) :: at(m)
      real(c_double), intent(out) :: values(m)
      real(c_double), intent(out) :: slopes(m)
      integer(c_int), intent(out) :: code
      character(len=256), intent(out) :: message

      type(table_type) :: table
      type(status_type) :: status
      integer :: i

      values = 0.0_c_double
      slopes = 0.0_c_double
      call new_table(table, x, y, status)
      call export_status(status, code, message)
      if (code /= ok) return
      do i = 1, m
         call value_and_slope(table, at(i), values(i), slopes(i))
      end do
   end subroutine table_eval

   !> Derived constants: bulk, shear, lame [Pa], strength scale [Pa], yield tolerance [Pa],
   !> virgin sin(phi), virgin c cos(phi) [Pa], limit of the band width [m].
   subroutine rock_scales(constants, table, k, options, scales, code, message)
      integer(c_int), intent(in) :: k
      real(c_double), intent(in) :: constants(6)
      real(c_double), intent(in) :: table(4, k)
      integer(c_int), intent(in) :: options(4)
      real(c_double), intent(out) :: scales(8)
      integer(c_int), intent(out) :: code
      character(len=256), intent(out) :: message

      type(rock_type) :: rock

      scales = 0.0_c_double
      call make_rock(constants, table, options, rock, code, message)
      if (code /= ok) return
      scales = [rock%bulk, rock%shear, rock%lame, rock%strength_scale, rock%yield_tolerance, &
         rock%sin_phi0, rock%c_cos_phi0, band_width_limit(rock)]
   end subroutine rock_scales

   !> sin(phi) and c cos(phi) [Pa] at effective plastic strains.
   subroutine strength_eval(constants, table, k, options, ep_eff, n, sin_phi, c_cos_phi, &
      code, message)
      integer(c_int), intent(in) :: k
      integer(c_int), intent(in) :: n
      real(c_double), intent(in) :: constants(6)
      real(c_double), intent(in) :: table(4, k)
      integer(c_int), intent(in) :: options(4)
      real(c_double), intent(in) :: ep_eff(n)
      real(c_double), intent(out) :: sin_phi(n)
      real(c_double), intent(out) :: c_cos_phi(n)
      integer(c_int), intent(out) :: code
      character(len=256), intent(out) :: message

      type(rock_type) :: rock
      integer :: i

      sin_phi = 0.0_c_double
      c_cos_phi = 0.0_c_double
      call make_rock(constants, table, options, rock, code, message)
      if (code /= ok) return
      do i = 1, n
         call strength_coefficients(rock, ep_eff(i), sin_phi(i), c_cos_phi(i))
      end do
   end subroutine strength_eval

   !> Band width [m] of triangles, its softening modulus [Pa], and the strength that is left.
   subroutine planes_soften(constants, table, k, options, areas, scale, ft, dep, n, widths, &
      moduli, strengths, code, message)
      integer(c_int), intent(in) :: k
      integer(c_int), intent(in) :: n
      real(c_double), intent(in) :: constants(6)
      real(c_double), intent(in) :: table(4, k)
      integer(c_int), intent(in) :: options(4)
      real(c_double), intent(in) :: areas(n)
      real(c_double), intent(in) :: scale
      real(c_double), intent(in) :: ft(n)
      real(c_double), intent(in) :: dep(n)
      real(c_double), intent(out) :: widths(n)
      real(c_double), intent(out) :: moduli(n)
      real(c_double), intent(out) :: strengths(n)
      integer(c_int), intent(out) :: code
      character(len=256), intent(out) :: message

      type(rock_type) :: rock
      integer :: i

      widths = band_width(areas, scale)
      moduli = 0.0_c_double
      strengths = 0.0_c_double
      call make_rock(constants, table, options, rock, code, message)
      if (code /= ok) return
      do i = 1, n
         moduli(i) = softening_modulus(rock, widths(i))
      end do
      strengths = softened_strength(ft, moduli, dep)
   end subroutine planes_soften

   !> Strength axes after they have followed `stresses`.
   subroutine axes_follow(stresses, old_axes, n, axes, code, message)
      integer(c_int), intent(in) :: n
      real(c_double), intent(in) :: stresses(4, n)
      real(c_double), intent(in) :: old_axes(2, n)
      real(c_double), intent(out) :: axes(2, n)
      integer(c_int), intent(out) :: code
      character(len=256), intent(out) :: message

      integer :: i

      axes = old_axes
      do i = 1, n
         call follow_axes(stresses(:, i), axes(:, i))
      end do
      code = ok
      message = ""
   end subroutine axes_follow

   !> Eq. 13 over a history of `n` steps: the running sum after each.
   subroutine crack_turn(damage, axes, n, cracks, code, message)
      integer(c_int), intent(in) :: n
      real(c_double), intent(in) :: damage(2, n)
      real(c_double), intent(in) :: axes(2, n)
      real(c_double), intent(out) :: cracks(2, n)
      integer(c_int), intent(out) :: code
      character(len=256), intent(out) :: message

      integer :: i
      real(c_double) :: crack(2)

      crack = 0.0_c_double
      do i = 1, n
         call turn_crack(damage(:, i), axes(:, i), crack)
         cracks(:, i) = crack
      end do
      code = ok
      message = ""
   end subroutine crack_turn

   !> Return mapping in principal space, any order of the stresses.
   subroutine return_principal(constants, table, k, options, softening, trials, ft, ep_old, n, &
      ep_eff, dep, dep_compressive, active, codes, code, message)
      !f2py threadsafe
      integer(c_int), intent(in) :: k
      integer(c_int), intent(in) :: n
      real(c_double), intent(in) :: constants(6)
      real(c_double), intent(in) :: table(4, k)
      integer(c_int), intent(in) :: options(4)
      real(c_double), intent(in) :: softening(n)     !! H, not positive [Pa]
      real(c_double), intent(in) :: trials(3, n)     !! [Pa]
      real(c_double), intent(in) :: ft(3, n)         !! [Pa]
      real(c_double), intent(in) :: ep_old(n)        !! [-]
      real(c_double), intent(out) :: ep_eff(n)
      real(c_double), intent(out) :: dep(3, n)
      real(c_double), intent(out) :: dep_compressive(3, n)
      integer(c_int), intent(out) :: active(n)
      integer(c_int), intent(out) :: codes(n)        !! of each return
      integer(c_int), intent(out) :: code
      character(len=256), intent(out) :: message

      type(rock_type) :: rock
      type(pyramid_return_type) :: quick
      integer :: first, i, lane, of_lane(pack)

      ep_eff = ep_old
      dep = 0.0_c_double
      dep_compressive = 0.0_c_double
      active = 0
      codes = ok
      call make_rock(constants, table, options, rock, code, message)
      if (code /= ok) return
      do first = 1, n, pack
         of_lane = min([(first + lane - 1, lane=1, pack)], n)
         call return_to_pyramid(rock, pack, softening(of_lane), transpose(trials(:, of_lane)), &
            transpose(ft(:, of_lane)), ep_old(of_lane), quick)
         do lane = 1, min(pack, n - first + 1)
            i = first + lane - 1
            if (.not. quick%done(lane)) then
               call return_to_surface(rock, softening(i), trials(:, i), ft(:, i), ep_eff(i), &
                  dep(:, i), dep_compressive(:, i), active(i), codes(i))
            else if (quick%active(lane) /= 0) then
               ep_eff(i) = quick%e(lane)
               dep(:, i) = quick%dep(lane, :)
               dep_compressive(:, i) = dep(:, i)
               active(i) = quick%active(lane)
            end if
         end do
      end do
   end subroutine return_principal

   !> Strain a batch of points by one increment each. Every state goes in and comes out, hence
   !> the many arguments: stress (4) [Pa], ep_eff, ft (3) [Pa], opening (3), axis (2), crack (2).
   subroutine point_step(constants, table, k, options, softening, strain, stress_old, ep_old, &
      ft_old, opening_old, axis_old, crack_old, n, stress, ep_eff, ft, opening, axis, crack, &
      dep, dep_compressive, active, codes, code, message)
      !f2py threadsafe
      integer(c_int), intent(in) :: k
      integer(c_int), intent(in) :: n
      real(c_double), intent(in) :: constants(6)
      real(c_double), intent(in) :: table(4, k)
      integer(c_int), intent(in) :: options(4)
      real(c_double), intent(in) :: softening(n)      !! H, not positive [Pa]
      real(c_double), intent(in) :: strain(4, n)      !! increments, engineering shear [-]
      real(c_double), intent(in) :: stress_old(4, n)
      real(c_double), intent(in) :: ep_old(n)
      real(c_double), intent(in) :: ft_old(3, n)
      real(c_double), intent(in) :: opening_old(3, n)
      real(c_double), intent(in) :: axis_old(2, n)
      real(c_double), intent(in) :: crack_old(2, n)
      real(c_double), intent(out) :: stress(4, n)
      real(c_double), intent(out) :: ep_eff(n)
      real(c_double), intent(out) :: ft(3, n)
      real(c_double), intent(out) :: opening(3, n)
      real(c_double), intent(out) :: axis(2, n)
      real(c_double), intent(out) :: crack(2, n)
      real(c_double), intent(out) :: dep(4, n)
      real(c_double), intent(out) :: dep_compressive(4, n)
      integer(c_int), intent(out) :: active(n)
      integer(c_int), intent(out) :: codes(n)
      integer(c_int), intent(out) :: code
      character(len=256), intent(out) :: message

      type(rock_type) :: rock
      type(point_type) :: point(pack)
      integer :: active_lane(pack), code_lane(pack), count, first, i, lane
      real(c_double) :: compressive(4, pack), flow(4, pack), now(4, pack), old(4, pack)
      real(c_double) :: slope(pack), strength(2, pack), trial(4, pack)

      call make_rock(constants, table, options, rock, code, message)
      if (code /= ok) return
      do first = 1, n, pack
         count = min(pack, n - first + 1)
         do lane = 1, count
            i = first + lane - 1
            point(lane) = point_type(ep_old(i), ft_old(:, i), opening_old(:, i), axis_old(:, i), &
               crack_old(:, i))
            slope(lane) = softening(i)
            old(:, lane) = stress_old(:, i)
            trial(:, lane) = stress_old(:, i) &
               + rock%shear*[2.0_c_double*strain(:3, i), strain(4, i)]
            trial(:3, lane) = trial(:3, lane) &
               + rock%lame*(strain(1, i) + strain(2, i) + strain(3, i))
         end do
         call update_pack(rock, count, slope, old, trial, point, now, flow, compressive, strength, &
            active_lane, code_lane)
         do lane = 1, count
            i = first + lane - 1
            stress(:, i) = now(:, lane)
            dep(:, i) = flow(:, lane)
            dep_compressive(:, i) = compressive(:, lane)
            active(i) = active_lane(lane)
            codes(i) = code_lane(lane)
            ep_eff(i) = point(lane)%ep_eff
            ft(:, i) = point(lane)%ft
            opening(:, i) = point(lane)%opening
            axis(:, i) = point(lane)%axis
            crack(:, i) = point(lane)%crack
         end do
      end do
   end subroutine point_step

   subroutine make_rock(constants, table, options, rock, code, message)
      real(c_double), intent(in) :: constants(6)
      real(c_double), intent(in) :: table(:, :)
      integer(c_int), intent(in) :: options(4)
      type(rock_type), intent(out) :: rock
      integer(c_int), intent(out) :: code
      character(len=*), intent(out) :: message

      type(status_type) :: status

      call new_rock(rock, constants, table, options, status)
      call export_status(status, code, message)
   end subroutine make_rock

   subroutine export_status(status, code, message)
      type(status_type), intent(in) :: status
      integer(c_int), intent(out) :: code
      character(len=*), intent(out) :: message

      code = status%code
      message = ""
      if (allocated(status%message)) message = status%message
   end subroutine export_status

end module kernels_material
