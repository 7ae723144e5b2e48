!> The time loop: forces, boundary, nodes, contact, cracks, and again.
!>
!> Between calls the fields are at time n: displacement u(n), internal force of u(n) and the
!> velocity of the half step after it. The next call starts by moving the nodes.
module lithofrac_run_step
   use lithofrac_base_kinds, only: wp
   use lithofrac_base_status, only: bad_input, no_return_map, ok, set_failure, status_type
   use lithofrac_contact_overlap, only: refuse_overlap
   use lithofrac_fracture_bonds, only: apply_bonds, bond_power, forget_bonds
   use lithofrac_fracture_fragment_drag, only: apply_drag, drag_power
   use lithofrac_mechanics_blocks, only: assemble
   use lithofrac_mechanics_internal_force, only: chunk_force, failure_type
   use lithofrac_mechanics_loads, only: apply_pressure, apply_velocity, work_after, work_before
   use lithofrac_mechanics_turns, only: chord_work, look, stretch_type
   use lithofrac_run_contact_step, only: bring_masses, book_contact, close_contacts, &
      note_velocities
   use lithofrac_run_damping, only: fit_affine, rayleigh_frequency
   use lithofrac_run_insert_cracks, only: insert_cracks
   use lithofrac_run_model, only: model_type
   use lithofrac_run_node_update, only: kinetic_of, move, sum_moments, update_affine, &
      update_ground, update_plain
   use lithofrac_run_observe, only: internal_energy, kinetic_energy
   use lithofrac_run_settings, only: no_damping, relative_to_affine
   use lithofrac_run_watch, only: check_state
   implicit none
   private

   public :: advance, start

   integer, parameter :: quotient_interval = 100      !! steps between Rayleigh quotients
   integer, parameter :: quotient_length = 10         !! steps that a quotient looks at
   integer, parameter :: look_interval = 10           !! steps between looks at the speed
   integer, parameter :: booked_steps = 100           !! after a fast one
   real(wp), parameter :: largest_alpha_dt = 0.05_wp  !! keeps the lagged drag stable

contains

   !> Forces and half-step velocity of time 0.
   subroutine start(model, status)
      type(model_type), intent(inout) :: model
      type(status_type), intent(out) :: status

      type(failure_type), allocatable :: failures(:)
      integer :: block, run

      if (model%started) return
      allocate (failures(model%blocks%n_blocks))
      model%blocks%buffer = 0.0_wp
      do block = 1, model%blocks%n_blocks
         call block_force(model, block, failures(block))
      end do
      call report_failure(model, failures, status)
      if (status%code /= ok) return
      do run = 1, model%blocks%n_runs
         call assemble(model%blocks, run, model%fields%internal)
      end do
      call load_boundary(model)
      model%fields%v = model%fields%v - 0.5_wp*model%dt*model%fields%inverse_mass &
         *(model%fields%external - model%fields%internal)
      do run = 1, model%blocks%n_runs
         model%moments(:, run) = sum_moments(model%fields, model%mesh%nodes, &
            model%blocks%first_node(run), model%blocks%first_node(run + 1) - 1, 0.0_wp, &
            model%affine(model%mesh%body_of_node(model%blocks%first_node(run)))%centre)
      end do
      call set_damping(model)
      if (model%contact%on) call note_velocities(model)
      do run = 1, model%blocks%n_runs
         call move_run(model, run, drift=.false.)
      end do
      if (model%contact%on) then
         call start_contact(model, status)
         if (status%code /= ok) return
      end if
      model%started = .true.
      model%fast_until = booked_steps
      model%ledger%initial = kinetic_energy(model) + sum(internal_energy(model))
      call check_state(model, status)
   end subroutine start

   !> Take `n_steps` steps.
   !>
   !> On a failure the model stays at the step that failed and can be looked at, not resumed.
   subroutine advance(model, n_steps, threads, status)
      type(model_type), intent(inout) :: model
      integer, intent(in) :: n_steps
      integer, intent(in) :: threads
      type(status_type), intent(out) :: status

      type(failure_type), allocatable :: failures(:)
      type(status_type) :: contact_status
      integer :: k, block, run
      logical :: failed

      if (n_steps < 0 .or. threads < 1) then
         call set_failure(status, bad_input, "advance: needs steps >= 0 and threads >= 1")
         return
      end if
      call start(model, status)
      if (status%code /= ok .or. n_steps == 0) return
      allocate (failures(model%blocks%n_blocks))
      failed = .false.
      !$omp parallel default(shared) private(k, block, run) num_threads(threads)
      !$omp do schedule(static)
      do run = 1, model%blocks%n_runs
         call drift_run(model, run)
      end do
      !$omp end do
      do k = 1, n_steps
         !$omp do schedule(static)
         do block = 1, model%blocks%n_blocks
            call block_force(model, block, failures(block))
         end do
         !$omp end do
         !$omp single
         call finish_step(model)
         failed = any(failures%code /= ok)
         !$omp end single
         if (failed) exit
         !$omp do schedule(static)
         do run = 1, model%blocks%n_runs
            call assemble(model%blocks, run, model%fields%internal)
            call move_run(model, run, drift=k < n_steps .and. .not. model%contact%on)
         end do
         !$omp end do
         if (.not. model%contact%on) cycle
         !$omp single
         call close_contacts(model, threads, contact_status)
         if (model%fracture%on .and. contact_status%code == ok) then
            call insert_cracks(model, contact_status)
            failures = [failures, spread(failure_type(), 1, &
               max(0, model%blocks%n_blocks - size(failures)))]
         end if
         !$omp end single
         if (contact_status%code /= ok) exit
         !$omp do schedule(static)
         do run = 1, model%blocks%n_runs
            call sum_run(model, run)
            if (k < n_steps) call drift_run(model, run)
         end do
         !$omp end do
      end do
      !$omp end parallel
      call report_failure(model, failures, status)
      if (status%code == ok) status = contact_status
      if (status%code == ok) call check_state(model, status)
   end subroutine advance

   !> Element forces of one block of chunks; in fast motion also the work of their turns.
   subroutine block_force(model, block, failure)
      type(model_type), intent(inout) :: model
      integer, intent(in) :: block
      type(failure_type), intent(inout) :: failure

      type(stretch_type) :: before, after
      logical :: is_fast
      integer :: chunk

      is_fast = model%step <= model%fast_until
      associate (blocks => model%blocks, chunks => model%chunks)
         blocks%chord(block) = 0.0_wp
         do chunk = blocks%first_chunk(block), blocks%first_chunk(block + 1) - 1
            associate (rock => model%rocks(chunks%body(chunk)))
               if (is_fast) call look(chunks, chunk, rock, model%fields, model%state, model%dt, &
                  before)
               call chunk_force(chunks, chunk, rock, model%fields, merge(model%dt, 0.0_wp, &
                  model%started), model%state, blocks%place(:, :, chunk), size(blocks%buffer, 2), &
                  blocks%buffer, failure)
               if (.not. is_fast) cycle
               call look(chunks, chunk, rock, model%fields, model%state, 0.0_wp, after)
               blocks%chord(block) = blocks%chord(block) + chord_work(chunks%volume(:, chunk), &
                  before, after)
            end associate
         end do
      end associate
   end subroutine block_force

   !> Book the step that ends, then set the boundary and the damping of the next.
   subroutine finish_step(model)
      type(model_type), intent(inout) :: model

      associate (ledger => model%ledger, dt => model%dt)
         if (model%step > 0) ledger%external = ledger%external &
            + work_before(model%velocities, model%pressures, dt, model%fields)
         ledger%external = ledger%external &
            + work_after(model%velocities, model%pressures, dt, model%fields)
         if (model%step > 0) ledger%damping = ledger%damping + 0.5_wp*dt*sum(model%sums(2, :))
         ledger%damping = ledger%damping + 0.5_wp*dt*sum(model%sums(3, :))
         if (model%fracture%on) call book_fracture(model)
         ledger%turning = ledger%turning - sum(model%blocks%chord)
      end associate
      call look_for_speed(model)
      if (model%contact%on) then
         call book_contact(model)
         call note_velocities(model)
      end if
      model%step = model%step + 1
      call load_boundary(model)
      call set_damping(model)
   end subroutine finish_step

   !> Book turns for some time from a step that is fast: a body that rings stands still twice in
   !> a period. The first steps are booked in any case.
   subroutine look_for_speed(model)
      type(model_type), intent(inout) :: model

      real(wp) :: energy
      integer :: run

      if (mod(model%step, look_interval) /= 0) return
      energy = 0.0_wp
      do run = 1, model%blocks%n_runs
         associate (first => model%blocks%first_node(run), &
               last => model%blocks%first_node(run + 1) - 1)
            energy = energy + kinetic_of(last - first + 1, model%fields%mass(first), &
               model%fields%v(1, first))
         end associate
      end do
      if (energy > model%fast_energy) model%fast_until = model%step + booked_steps
   end subroutine look_for_speed

   subroutine load_boundary(model)
      type(model_type), intent(inout) :: model

      integer :: load, i

      do load = 1, size(model%pressures)
         do i = 1, size(model%pressures(load)%edge, 2)
            model%fields%external(:, model%pressures(load)%edge(:, i)) = 0.0_wp
         end do
      end do
      if (model%fracture%on) call pull_on_cracks(model)
      do load = 1, size(model%pressures)
         call apply_pressure(model%pressures(load), model%mesh%nodes, &
            model%chunks%axisymmetric, model%step*model%dt, model%fields)
      end do
      do load = 1, size(model%velocities)
         call apply_velocity(model%velocities(load), (model%step + 0.5_wp)*model%dt, model%fields)
      end do
   end subroutine load_boundary

   !> Work of fading bonds and of the drag on fragments, half of it on either side of its time.
   subroutine book_fracture(model)
      type(model_type), intent(inout) :: model

      associate (bonds => model%fracture%bonds, drag => model%fracture%drag, v => model%fields%v)
         model%ledger%insertion = model%ledger%insertion &
            + 0.5_wp*model%dt*(bonds%power_before + bond_power(bonds, v))
         model%ledger%damping = model%ledger%damping &
            + 0.5_wp*model%dt*(drag%power_before + drag_power(drag, v))
      end associate
   end subroutine book_fracture

   !> Forces of this step that bonds and the drag on fragments put on the nodes.
   subroutine pull_on_cracks(model)
      type(model_type), intent(inout) :: model

      integer :: i

      associate (bonds => model%fracture%bonds, drag => model%fracture%drag, &
            fields => model%fields)
         do i = 1, size(bonds%list)
            fields%external(:, bonds%list(i)%node) = 0.0_wp
         end do
         do i = 1, size(drag%node)
            fields%external(:, drag%node(i)) = 0.0_wp
         end do
         call forget_bonds(bonds, model%step)
         call apply_bonds(bonds, model%step, fields%v, fields%external)
         call apply_drag(drag, model%alpha, model%mesh%body_of_node, model%mesh%nodes, fields%u, &
            fields%v, fields%mass, fields%external)
      end associate
   end subroutine pull_on_cracks

   subroutine set_damping(model)
      type(model_type), intent(inout) :: model

      integer :: body, run
      real(wp), allocatable :: sums(:, :)

      if (model%settings%damping == no_damping) return
      if (model%settings%damping_alpha < 0.0_wp) call update_alpha(model)
      if (model%settings%damping /= relative_to_affine) return
      allocate (sums(size(model%moments, 1), model%mesh%n_bodies), source=0.0_wp)
      do run = 1, model%blocks%n_runs
         body = model%mesh%body_of_node(model%blocks%first_node(run))
         sums(:, body) = sums(:, body) + model%moments(:, run)
      end do
      do body = 1, model%mesh%n_bodies
         model%affine(body) = fit_affine(sums(:, body), model%affine(body)%centre)
      end do
   end subroutine set_damping

   !> Rayleigh quotient of one increment in every interval: the frequency that is in motion.
   subroutine update_alpha(model)
      type(model_type), intent(inout) :: model

      real(wp), allocatable :: u(:, :)
      integer :: body, phase

      phase = mod(model%step, quotient_interval)
      if (phase /= 0 .and. phase /= quotient_length) return
      ! The internal force at hand is that of the step before; so is this displacement.
      u = model%fields%u
      if (model%step > 0) u = u - model%dt*model%fields%v
      if (phase == 0) then
         model%reference_u = u
         model%reference_f = model%fields%internal
         model%reference_step = model%step
         if (model%step == 0) model%alpha = alpha_of(model, model%lowest_frequency)
      else if (model%reference_step >= 0) then
         do body = 1, model%mesh%n_bodies
            model%alpha(body) = alpha_of(model, rayleigh_frequency(body, &
               model%mesh%body_of_node(:model%mesh%n_nodes), model%fields%drag_mass, &
               u - model%reference_u, model%fields%internal - model%reference_f, &
               model%lowest_frequency(body)))
         end do
      end if
   end subroutine update_alpha

   elemental function alpha_of(model, omega) result(alpha)
      type(model_type), intent(in) :: model
      real(wp), intent(in) :: omega   !! [1/s]
      real(wp) :: alpha

      alpha = min(2.0_wp*model%settings%damping_fraction*omega, largest_alpha_dt/model%dt)
   end function alpha_of

   !> New velocities of a run of nodes, and new positions when `drift`.
   subroutine move_run(model, run, drift)
      type(model_type), intent(inout) :: model
      integer, intent(in) :: run
      logical, intent(in) :: drift

      integer :: first, last, body

      first = model%blocks%first_node(run)
      last = model%blocks%first_node(run + 1) - 1
      body = model%mesh%body_of_node(first)
      select case (model%settings%damping)
      case (no_damping)
         call update_plain(model%fields, first, last, model%dt, drift, model%sums(:, run))
      case (relative_to_affine)
         call update_affine(model%fields, model%mesh%nodes, first, last, model%dt, drift, &
            model%alpha(body), model%affine(body), model%sums(:, run), model%moments(:, run))
      case default
         call update_ground(model%fields, first, last, model%dt, drift, model%alpha(body), &
            model%sums(:, run))
      end select
   end subroutine move_run

   !> Move a run of nodes with the velocities of the half step.
   subroutine drift_run(model, run)
      type(model_type), intent(inout) :: model
      integer, intent(in) :: run

      associate (first => model%blocks%first_node(run), &
            last => model%blocks%first_node(run + 1) - 1)
         call move(last - first + 1, model%dt, model%fields%v(1, first), model%fields%u(1, first))
      end associate
   end subroutine drift_run

   !> Moments of a run of nodes once contact has changed its velocities.
   subroutine sum_run(model, run)
      type(model_type), intent(inout) :: model
      integer, intent(in) :: run

      if (model%settings%damping /= relative_to_affine) return
      model%moments(:, run) = sum_moments(model%fields, model%mesh%nodes, &
         model%blocks%first_node(run), model%blocks%first_node(run + 1) - 1, model%dt, &
         model%affine(model%mesh%body_of_node(model%blocks%first_node(run)))%centre)
   end subroutine sum_run

   !> Contact at time 0, where a given displacement may have made parts overlap.
   subroutine start_contact(model, status)
      type(model_type), intent(inout) :: model
      type(status_type), intent(out) :: status

      integer :: run

      associate (surfaces => model%contact%surfaces)
         surfaces%u = model%fields%u(:, surfaces%node)
      end associate
      call refuse_overlap(model%mesh, model%fields%u, model%origin, "contact", status)
      if (status%code /= ok) return
      call bring_masses(model)
      call close_contacts(model, 1, status)
      do run = 1, model%blocks%n_runs
         call sum_run(model, run)
      end do
   end subroutine start_contact

   !> Put the first failure into words.
   subroutine report_failure(model, failures, status)
      type(model_type), intent(in) :: model
      type(failure_type), intent(in) :: failures(:)
      type(status_type), intent(out) :: status

      integer :: block
      character(len=240) :: words

      do block = 1, size(failures)
         if (failures(block)%code == ok) cycle
         write (words, "(a, i0, a, es12.4e3, a, i0, a, 4es12.3e3, a)") "step ", model%step, &
            ", time ", model%step*model%dt, " s, element ", failures(block)%element, &
            ": no consistent return of the trial stress", failures(block)%trial*1.0e-6_wp, &
            " MPa (xx, yy, zz, xy); try a smaller time_step_factor or loading speed"
         call set_failure(status, no_return_map, trim(words))
         return
      end do
   end subroutine report_failure

end module lithofrac_run_step
