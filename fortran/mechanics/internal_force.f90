!> Stress and nodal forces of one chunk of elements: predict, check, return, sum.
!>
!> All variants share one predictor. An elastic body skips the check, a virgin chunk reads its
!> strength from one line, and only flagged elements go through the scalar return mapping.
module lithofrac_mechanics_internal_force
   use lithofrac_base_kinds, only: wp
   use lithofrac_base_status, only: ok
   use lithofrac_material_pyramid_return, only: pack, padded
   use lithofrac_material_rock, only: rock_type
   use lithofrac_material_stress_update, only: point_type, update_pack
   use lithofrac_mechanics_chunks, only: chunks_type, width
   use lithofrac_mechanics_fields, only: fields_type, inelastic_type
   use lithofrac_mechanics_kinematics, only: elastic_forces, elastic_stress, gather, &
      gather_previous, hoop_strain, nodal_forces, scatter, scatter_hoop, strains, virgin_forces
   implicit none
   private

   public :: chunk_force, chunk_stress, element_force, failure_type

   !> What went wrong in an element, for words where step and time are known.
   type :: failure_type
      integer :: code = ok
      integer :: element = 0
      real(wp) :: trial(4) = 0.0_wp   !! trial stress [Pa]
   end type failure_type

   real(wp), parameter :: no_strain(width, 4) = 0.0_wp
   real(wp), parameter :: equal_stress = 1.0e-12_wp  !! relative: in-plane axes keep their place

contains

   !> Update the material of a chunk and add its nodal forces to the buffer of its block.
   subroutine chunk_force(chunks, chunk, rock, fields, dt, state, place, n_places, buffer, &
      failure)
      type(chunks_type), intent(in) :: chunks
      integer, intent(in) :: chunk
      type(rock_type), intent(in) :: rock
      type(fields_type), intent(in) :: fields
      real(wp), intent(in) :: dt                           !! step that led here [s]
      type(inelastic_type), intent(inout) :: state
      integer, intent(in) :: place(width, 3)               !! of the corners in `buffer`
      integer, intent(in) :: n_places
      real(wp), intent(inout) :: buffer(2, n_places)       !! [N]
      type(failure_type), intent(inout) :: failure

      real(wp) :: strain(width, 4), rotation(width, 3), stress(width, 4), force(width, 4)
      real(wp) :: du(width, 4)
      logical :: done

      associate (gradient => chunks%gradient(:, :, chunk), volume => chunks%volume(:, chunk))
         call displacements(chunks, chunk, fields, du, strain(:, 3))
         done = .false.
         if (.not. rock%yields) then
            call elastic_forces(rock, gradient, volume, du, strain(:, 3), force, stress(:, 3))
            done = .true.
         else if (.not. state%touched(chunk)) then
            call virgin_forces(rock, gradient, volume, du, strain(:, 3), force, stress(:, 3), done)
         end if
         if (.not. done) then
            call predict(chunks, chunk, rock, du, state, strain, rotation, stress)
            call return_flagged(chunks, chunk, rock, fields, dt, state, stress, failure)
            call nodal_forces(width, gradient, volume, strain, rotation, stress, force)
         end if
         call scatter(place, force, n_places, buffer)
         if (chunks%axisymmetric) call scatter_hoop(place, chunks%hoop(:, chunk), volume, &
            stress(:, 3), n_places, buffer)
      end associate
   end subroutine chunk_force

   !> Strain and stress of a chunk as it is, without any update.
   subroutine chunk_stress(chunks, chunk, rock, fields, state, strain, stress)
      type(chunks_type), intent(in) :: chunks
      integer, intent(in) :: chunk
      type(rock_type), intent(in) :: rock
      type(fields_type), intent(in) :: fields
      type(inelastic_type), intent(in) :: state
      real(wp), intent(out) :: strain(width, 4)   !! U - I, unrotated, engineering shear
      real(wp), intent(out) :: stress(width, 4)   !! unrotated [Pa]

      real(wp) :: du(width, 4), rotation(width, 3)

      call displacements(chunks, chunk, fields, du, strain(:, 3))
      call predict(chunks, chunk, rock, du, state, strain, rotation, stress)
   end subroutine chunk_stress

   !> Forces of one element on its corners as it is, without any update; not axisymmetric.
   function element_force(chunks, element, rock, fields, state) result(force)
      type(chunks_type), intent(in) :: chunks
      integer, intent(in) :: element
      type(rock_type), intent(in) :: rock
      type(fields_type), intent(in) :: fields
      type(inelastic_type), intent(in) :: state
      real(wp) :: force(2, 3)                     !! [N]

      real(wp) :: before(2, 3), du(4), gradient(4), inelastic(4), strain(4), rotation(3), &
         stress(4), corners(4)
      integer :: corner(3), chunk, lane

      chunk = chunks%chunk_of(element)
      lane = chunks%lane_of(element)
      corner = chunks%node(lane, :, chunk)
      gradient = chunks%gradient(lane, :, chunk)
      inelastic = state%strain(lane, :, chunk)
      before = fields%u(:, corner)
      du(1:2) = before(:, 2) - before(:, 1)
      du(3:4) = before(:, 3) - before(:, 1)
      strain(3) = 0.0_wp
      call strains(1, gradient, du, strain, rotation)
      call elastic_stress(1, rock%lame, rock%shear, strain, inelastic, stress)
      call nodal_forces(1, gradient, chunks%volume(lane:lane, chunk), strain, rotation, stress, &
         corners)
      force(:, 2) = corners(1:2)
      force(:, 3) = corners(3:4)
      force(:, 1) = -(corners(1:2) + corners(3:4))
   end function element_force

   !> Displacements of the corners relative to corner 1, and the strain out of the plane.
   subroutine displacements(chunks, chunk, fields, du, strain_zz)
      type(chunks_type), intent(in) :: chunks
      integer, intent(in) :: chunk
      type(fields_type), intent(in) :: fields
      real(wp), intent(out) :: du(width, 4)              !! [m]
      real(wp), intent(out) :: strain_zz(width)

      call gather(chunks%node(:, :, chunk), size(fields%u, 2), fields%u, du)
      if (chunks%axisymmetric) then
         call hoop_strain(chunks%node(:, :, chunk), size(fields%u, 2), fields%u, &
            chunks%hoop(:, chunk), strain_zz)
      else
         strain_zz = 0.0_wp
      end if
   end subroutine displacements

   !> Strain, rotation and trial stress of a chunk.
   subroutine predict(chunks, chunk, rock, du, state, strain, rotation, stress)
      type(chunks_type), intent(in) :: chunks
      integer, intent(in) :: chunk
      type(rock_type), intent(in) :: rock
      real(wp), intent(in) :: du(width, 4)
      type(inelastic_type), intent(in) :: state
      real(wp), intent(inout) :: strain(width, 4)        !! zz is given
      real(wp), intent(out) :: rotation(width, 3)
      real(wp), intent(out) :: stress(width, 4)

      call strains(width, chunks%gradient(:, :, chunk), du, strain, rotation)
      if (state%touched(chunk)) then
         call elastic_stress(width, rock%lame, rock%shear, strain, state%strain(:, :, chunk), &
            stress)
      else
         call elastic_stress(width, rock%lame, rock%shear, strain, no_strain, stress)
      end if
   end subroutine predict

   !> Find the elements beyond their strength and bring each back.
   subroutine return_flagged(chunks, chunk, rock, fields, dt, state, stress, failure)
      type(chunks_type), intent(in) :: chunks
      integer, intent(in) :: chunk
      type(rock_type), intent(in) :: rock
      type(fields_type), intent(in) :: fields
      real(wp), intent(in) :: dt
      type(inelastic_type), intent(inout) :: state
      real(wp), intent(inout) :: stress(width, 4)
      type(failure_type), intent(inout) :: failure

      real(wp) :: excess(width), axis(width, 2)
      integer :: flagged(width), lane, n, first

      if (.not. state%touched(chunk)) then
         call check_virgin(stress, rock, excess)
         if (maxval(excess) <= rock%yield_tolerance) return
         state%touched(chunk) = .true.
      end if
      call check_softened(stress, state%axis(:, :, chunk), state%ft(:, :, chunk), &
         state%sin_phi(:, chunk), state%c_cos_phi(:, chunk), excess, axis)
      if (maxval(excess) > rock%yield_tolerance) then
         n = 0
         do lane = 1, chunks%filled(chunk)
            flagged(n + 1) = lane
            if (excess(lane) > rock%yield_tolerance) n = n + 1
         end do
         do first = 1, n, pack
            call return_lanes(chunks, chunk, flagged(first:min(first + pack - 1, n)), rock, &
               fields, dt, state, stress, failure)
         end do
      end if
      where (excess <= rock%yield_tolerance)
         state%axis(:, 1, chunk) = axis(:, 1)
         state%axis(:, 2, chunk) = axis(:, 2)
      end where
   end subroutine return_flagged

   !> How far the stress lies beyond the virgin strength [Pa], negative inside.
   pure subroutine check_virgin(stress, rock, excess)
      real(wp), intent(in) :: stress(width, 4)
      type(rock_type), intent(in) :: rock
      real(wp), intent(out) :: excess(width)

      integer :: i
      real(wp) :: mean, half, radius, high, low

      associate (sin_phi => rock%sin_phi0, c_cos_phi => rock%c_cos_phi0, &
            ft => rock%tensile_strength)
         !$omp simd private(mean, half, radius, high, low)
         do i = 1, width
            mean = 0.5_wp*(stress(i, 1) + stress(i, 2))
            half = 0.5_wp*(stress(i, 1) - stress(i, 2))
            radius = sqrt(half*half + stress(i, 4)*stress(i, 4))
            high = max(mean + radius, stress(i, 3))
            low = min(mean - radius, stress(i, 3))
            excess(i) = max(0.5_wp*(high - low) + 0.5_wp*(high + low)*sin_phi - c_cos_phi, &
               high - ft)
         end do
      end associate
   end subroutine check_virgin

   !> The same for softened, anisotropic strength; the strengths belong to the nearest axes.
   pure subroutine check_softened(stress, old_axis, ft, sin_phi, c_cos_phi, excess, axis)
      real(wp), intent(in) :: stress(width, 4)
      real(wp), intent(in) :: old_axis(width, 2)    !! cos 2a, sin 2a
      real(wp), intent(in) :: ft(width, 3)          !! [Pa]
      real(wp), intent(in) :: sin_phi(width)
      real(wp), intent(in) :: c_cos_phi(width)      !! [Pa]
      real(wp), intent(out) :: excess(width)        !! [Pa]
      real(wp), intent(out) :: axis(width, 2)       !! axes after an elastic step

      integer :: i
      real(wp) :: mean, half, radius, high, low, turn, first, second, by_radius, least
      logical :: keeps

      !$omp simd private(mean, half, radius, high, low, turn, first, second) &
      !$omp& private(by_radius, least, keeps)
      do i = 1, width
         mean = 0.5_wp*(stress(i, 1) + stress(i, 2))
         half = 0.5_wp*(stress(i, 1) - stress(i, 2))
         radius = sqrt(half*half + stress(i, 4)*stress(i, 4))
         turn = half*old_axis(i, 1) + stress(i, 4)*old_axis(i, 2)
         keeps = turn >= 0.0_wp
         first = mean + merge(radius, -radius, keeps)
         second = mean - merge(radius, -radius, keeps)
         high = max(mean + radius, stress(i, 3))
         low = min(mean - radius, stress(i, 3))
         excess(i) = max( &
            max(0.5_wp*(high - low) + 0.5_wp*(high + low)*sin_phi(i) - c_cos_phi(i), &
            first - ft(i, 1)), max(second - ft(i, 2), stress(i, 3) - ft(i, 3)))
         by_radius = 1.0_wp/max(radius, tiny(radius))
         by_radius = merge(by_radius, -by_radius, keeps)
         least = equal_stress*max(abs(stress(i, 1)), abs(stress(i, 2)), abs(stress(i, 3)))
         axis(i, 1) = merge(half*by_radius, old_axis(i, 1), radius > least)
         axis(i, 2) = merge(stress(i, 4)*by_radius, old_axis(i, 2), radius > least)
      end do
   end subroutine check_softened

   !> Return up to `pack` elements to their strength and book the energy that each dissipates
   !> (trapezoid).
   subroutine return_lanes(chunks, chunk, lanes, rock, fields, dt, state, stress, failure)
      type(chunks_type), intent(in) :: chunks
      integer, intent(in) :: chunk
      integer, intent(in) :: lanes(:)
      type(rock_type), intent(in) :: rock
      type(fields_type), intent(in) :: fields
      real(wp), intent(in) :: dt
      type(inelastic_type), intent(inout) :: state
      real(wp), intent(inout) :: stress(width, 4)
      type(failure_type), intent(inout) :: failure

      type(point_type) :: point(pack)
      real(wp), dimension(4, pack) :: old, trial, sigma, dep, dep_compressive
      real(wp) :: strength(2, pack), softening(pack)
      integer :: active(pack), code(pack), i, lane

      call previous_stress(chunks, chunk, lanes, rock, fields, dt, state, old)
      associate (ep_eff => state%plastic_strain(:, chunk), ft => state%ft(:, :, chunk), &
            opening => state%opening(:, :, chunk), axis => state%axis(:, :, chunk), &
            crack => state%crack(:, :, chunk), dissipated => state%dissipated(:, :, chunk), &
            strain => state%strain(:, :, chunk))
         do i = 1, size(lanes)
            lane = lanes(i)
            trial(:, i) = stress(lane, :)
            softening(i) = state%softening(lane, chunk)
            point(i) = point_type(ep_eff(lane), ft(lane, :), opening(lane, :), axis(lane, :), &
               crack(lane, :))
         end do
         call update_pack(rock, size(lanes), softening, old, trial, point, sigma, dep, &
            dep_compressive, strength, active, code)
         do i = 1, size(lanes)
            lane = lanes(i)
            if (code(i) /= ok) then
               if (failure%code == ok) then
                  failure = failure_type(code(i), chunks%element(lane, chunk), trial(:, i))
               end if
               cycle
            end if
            stress(lane, :) = sigma(:, i)
            strain(lane, :) = strain(lane, :) + dep(:, i)
            dissipated(lane, 1) = dissipated(lane, 1) &
               + 0.5_wp*dot_product(old(:, i) + sigma(:, i), dep_compressive(:, i))
            dissipated(lane, 2) = dissipated(lane, 2) &
               + 0.5_wp*dot_product(old(:, i) + sigma(:, i), dep(:, i) - dep_compressive(:, i))
            if (point(i)%ep_eff > ep_eff(lane)) then
               state%sin_phi(lane, chunk) = strength(1, i)
               state%c_cos_phi(lane, chunk) = strength(2, i)
            end if
            ep_eff(lane) = point(i)%ep_eff
            ft(lane, :) = point(i)%ft
            opening(lane, :) = point(i)%opening
            axis(lane, :) = point(i)%axis
            crack(lane, :) = point(i)%crack
         end do
      end associate
   end subroutine return_lanes

   !> Stress of some elements at the start of the step [Pa]: recomputed, because nearly no element
   !> needs it.
   subroutine previous_stress(chunks, chunk, lanes, rock, fields, dt, state, old)
      type(chunks_type), intent(in) :: chunks
      integer, intent(in) :: chunk
      integer, intent(in) :: lanes(:)             !! up to `pack` of them
      type(rock_type), intent(in) :: rock
      type(fields_type), intent(in) :: fields
      real(wp), intent(in) :: dt
      type(inelastic_type), intent(in) :: state
      real(wp), intent(out) :: old(4, pack)

      integer :: corner(3), i, lane, n

      n = padded(size(lanes))
      block
         real(wp), dimension(n, 4) :: du, gradient, inelastic, strain, stress
         real(wp) :: rotation(n, 3)

         do i = 1, n
            lane = lanes(min(i, size(lanes)))
            corner = chunks%node(lane, :, chunk)
            call gather_previous(corner, fields%u, fields%v, dt, du(i, :))
            gradient(i, :) = chunks%gradient(lane, :, chunk)
            inelastic(i, :) = state%strain(lane, :, chunk)
            strain(i, 3) = 0.0_wp
            if (chunks%axisymmetric) strain(i, 3) = chunks%hoop(lane, chunk) &
               *sum(fields%u(1, corner) - dt*fields%v(1, corner))
         end do
         call strains(n, gradient, du, strain, rotation)
         call elastic_stress(n, rock%lame, rock%shear, strain, inelastic, stress)
         do i = 1, size(lanes)
            old(:, i) = stress(i, :)
         end do
      end block
   end subroutine previous_stress

end module lithofrac_mechanics_internal_force
