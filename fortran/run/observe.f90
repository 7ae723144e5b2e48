!> Look at a run: ledger, boundary records, element state. Only the largest energy that was
!> seen is noted, as a scale of the residual; no field changes.
module lithofrac_run_observe
   use lithofrac_base_kinds, only: wp
   use lithofrac_mechanics_chunks, only: width
   use lithofrac_mechanics_internal_force, only: chunk_stress
   use lithofrac_mechanics_loads, only: prescribed_kinetic, pressure_record, velocity_record, &
      work_before
   use lithofrac_run_energy, only: ledger_type
   use lithofrac_run_model, only: model_type
   implicit none
   private

   public :: element_state, energy_now, internal_energy, kinetic_energy, load_records
   public :: n_element_state

   integer, parameter :: n_element_state = 17  !! rows of `element_state`

contains

   !> The ledger at the time of the fields; also notes the peak of the internal energy.
   subroutine energy_now(model, ledger)
      type(model_type), intent(inout) :: model
      type(ledger_type), intent(out) :: ledger

      real(wp) :: energy(3)

      ledger = model%ledger
      energy = internal_energy(model)
      ledger%elastic = energy(1)
      ledger%compressive = energy(2)
      ledger%fracture = energy(3)
      ledger%kinetic = kinetic_energy(model)
      if (model%step > 0) then
         ledger%external = ledger%external &
            + work_before(model%velocities, model%pressures, model%dt, model%fields)
         ledger%damping = ledger%damping + 0.5_wp*model%dt*sum(model%sums(2, :))
         ledger%contact = ledger%contact + model%contact%work_before(1)
         ledger%friction = ledger%friction + model%contact%work_before(2)
         ledger%insertion = ledger%insertion &
            + 0.5_wp*model%dt*model%fracture%bonds%power_before
         ledger%damping = ledger%damping + 0.5_wp*model%dt*model%fracture%drag%power_before
      end if
      model%ledger%scale = max(model%ledger%scale, ledger%elastic + ledger%compressive &
         + ledger%fracture)
      ledger%scale = model%ledger%scale
   end subroutine energy_now

   !> 1/2 v(n-1/2) M v(n+1/2) [J].
   function kinetic_energy(model) result(energy)
      type(model_type), intent(in) :: model
      real(wp) :: energy

      energy = sum(model%sums(1, :)) + prescribed_kinetic(model%velocities, model%fields)
   end function kinetic_energy

   !> Elastic energy and what the Mohr-Coulomb and the tension planes have dissipated [J].
   function internal_energy(model) result(energy)
      type(model_type), intent(in) :: model
      real(wp) :: energy(3)

      integer :: chunk

      energy = 0.0_wp
      do chunk = 1, model%chunks%n_chunks
         energy = energy + chunk_energy(model, chunk)
      end do
   end function internal_energy

   !> Elastic, compressive and fracture energy of a chunk [J].
   function chunk_energy(model, chunk) result(energy)
      type(model_type), intent(in) :: model
      integer, intent(in) :: chunk
      real(wp) :: energy(3)

      real(wp) :: strain(width, 4), stress(width, 4)

      associate (rock => model%rocks(model%chunks%body(chunk)), &
            volume => model%chunks%volume(:, chunk))
         call chunk_stress(model%chunks, chunk, rock, model%fields, model%state, strain, stress)
         strain = strain - model%state%strain(:, :, chunk)
         energy(1) = 0.5_wp*sum(volume*sum(stress*strain, dim=2))
         energy(2) = sum(volume*model%state%dissipated(:, 1, chunk))
         energy(3) = sum(volume*model%state%dissipated(:, 2, chunk))
      end associate
   end function chunk_energy

   !> Force [N] and displacement [m] of every load: velocities first, then pressures.
   subroutine load_records(model, records)
      type(model_type), intent(in) :: model
      real(wp), intent(out) :: records(:, :)   !! (2, n_velocities + n_pressures)

      integer :: i, n

      n = size(model%velocities)
      do i = 1, n
         call velocity_record(model%velocities(i), model%dt, model%fields, records(1, i), &
            records(2, i))
      end do
      do i = 1, size(model%pressures)
         call pressure_record(model%pressures(i), model%step*model%dt, model%fields, &
            records(1, n + i), records(2, n + i))
      end do
   end subroutine load_records

   !> State of some elements, in the frame that rotates with the material.
   !>
   !> Rows: stress xx, yy, zz, xy [Pa]; strain xx, yy, zz, xy (engineering shear); effective
   !> plastic strain; tensile strengths [Pa] 1, 2, zz; fracturing strains 1, 2, zz; angle of
   !> axis 1 [rad]; averaged crack normal of eq. 13 [rad], 0 where nothing has softened.
   subroutine element_state(model, elements, values)
      type(model_type), intent(in) :: model
      integer, intent(in) :: elements(:)
      real(wp), intent(out) :: values(:, :)    !! (n_element_state, size(elements))

      real(wp) :: strain(width, 4), stress(width, 4)
      integer :: i, chunk_known

      chunk_known = 0
      do i = 1, size(elements)
         associate (lane => model%chunks%lane_of(elements(i)), &
               chunk => model%chunks%chunk_of(elements(i)), state => model%state)
            if (chunk /= chunk_known) call chunk_stress(model%chunks, chunk, &
               model%rocks(model%chunks%body(chunk)), model%fields, state, strain, stress)
            chunk_known = chunk
            values(1:4, i) = stress(lane, :)
            values(5:8, i) = strain(lane, :)
            values(9, i) = state%plastic_strain(lane, chunk)
            values(10:12, i) = state%ft(lane, :, chunk)
            values(13:15, i) = state%opening(lane, :, chunk)
            values(16, i) = 0.5_wp*atan2(state%axis(lane, 2, chunk), state%axis(lane, 1, chunk))
            values(17, i) = 0.5_wp*atan2(state%crack(lane, 2, chunk), state%crack(lane, 1, chunk))
         end associate
      end do
   end subroutine element_state

end module lithofrac_run_observe
