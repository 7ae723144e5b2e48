!> What Python may do with a run. Only intrinsic types and explicit shapes here: this is the
!> file that f2py reads. Every routine ends with `code`, `message`; numbers start at 1.
module run_face
   use, intrinsic :: iso_c_binding, only: c_double, c_int
   use lithofrac_base_status, only: bad_input, ok, set_failure, status_type
   use lithofrac_contact_overlap, only: refuse_overlap
   use lithofrac_fracture_element_failure, only: set_failure_factors
   use lithofrac_fracture_fragments, only: find_parts
   use lithofrac_material_rock, only: new_rock, rock_type
   use lithofrac_mechanics_loads, only: ramp_type
   use lithofrac_run_check, only: check_model
   use lithofrac_run_checkpoint, only: checkpoint_size, restore, save_state
   use lithofrac_run_energy, only: ledger_type, pack_ledger
   use lithofrac_run_model, only: add_contact, add_fracture, add_pressure, add_velocity, &
      model_type, new_model, set_motion, tag_surface
   use lithofrac_run_observe, only: element_state, energy_now, load_records
   use lithofrac_run_settings, only: settings_type
   use lithofrac_run_step, only: advance
   use lithofrac_run_watch, only: look, sight_type
   implicit none
   private

   public :: run_new, run_drop, run_add_velocity, run_add_pressure, run_set_motion
   public :: run_advance, run_clock, run_energy, run_loads, run_elements, run_nodes
   public :: run_add_contact, run_tag_surface, run_contact_forces, run_contact_statistics
   public :: run_refuse_overlap
   public :: run_add_fracture, run_sizes, run_mesh, run_parts, run_failure, run_cracks, run_check
   public :: run_checkpoint_size, run_save, run_restore, run_watch

   integer, parameter :: max_runs = 64

   type :: slot_type
      type(model_type), allocatable :: model
   end type slot_type

   type(slot_type) :: slots(max_runs)

contains

   !> Build a run at rest; `run` is the handle for all later calls.
   subroutine run_new(nodes, n_nodes, triangles, body, n_elements, axisymmetric, constants, &
         tables, knots, options, n_bodies, n_knots, band_factor, time_step_factor, damping, &
         fraction, alpha, run, code, message)
      integer(c_int), intent(in) :: n_nodes, n_elements, n_bodies, n_knots
      real(c_double), intent(in) :: nodes(2, n_nodes)          !! [m]
      integer(c_int), intent(in) :: triangles(3, n_elements)   !! counter-clockwise
      integer(c_int), intent(in) :: body(n_elements)
      integer(c_int), intent(in) :: axisymmetric               !! 0 or 1
      real(c_double), intent(in) :: constants(6, n_bodies)     !! as `new_rock`
      real(c_double), intent(in) :: tables(4, n_knots, n_bodies)
      integer(c_int), intent(in) :: knots(n_bodies)            !! knots in use of each table
      integer(c_int), intent(in) :: options(4, n_bodies)
      real(c_double), intent(in) :: band_factor(n_bodies)      !! width is sqrt(factor area)
      real(c_double), intent(in) :: time_step_factor
      integer(c_int), intent(in) :: damping                    !! as `settings_type`
      real(c_double), intent(in) :: fraction
      real(c_double), intent(in) :: alpha                      !! [1/s], negative: at run time
      integer(c_int), intent(out) :: run                       !! 0 on failure
      integer(c_int), intent(out) :: code
      character(len=256), intent(out) :: message

      type(status_type) :: status
      type(rock_type) :: rocks(n_bodies)
      integer :: i, slot

      run = 0
      do i = 1, n_bodies
         call new_rock(rocks(i), constants(:, i), tables(:, :knots(i), i), options(:, i), status)
         call export_status(status, code, message)
         if (code /= ok) return
      end do
      do slot = 1, max_runs
         if (.not. allocated(slots(slot)%model)) exit
      end do
      if (slot > max_runs) then
         call set_failure(status, bad_input, "too many runs are open")
         call export_status(status, code, message)
         return
      end if
      allocate (slots(slot)%model)
      call new_model(slots(slot)%model, nodes, triangles, body, axisymmetric /= 0, rocks, &
         band_factor, settings_type(time_step_factor, damping, fraction, alpha), status)
      call export_status(status, code, message)
      if (code == ok) then
         run = slot
      else
         deallocate (slots(slot)%model)
      end if
   end subroutine run_new

   !> Forget a run.
   subroutine run_drop(run, code, message)
      integer(c_int), intent(in) :: run
      integer(c_int), intent(out) :: code
      character(len=256), intent(out) :: message

      call check_handle(run, code, message)
      if (code == ok) deallocate (slots(run)%model)
   end subroutine run_drop

   !> Prescribe one velocity component of some nodes.
   subroutine run_add_velocity(run, node, n, component, speed, start, duration, code, message)
      integer(c_int), intent(in) :: run, n
      integer(c_int), intent(in) :: node(n)
      integer(c_int), intent(in) :: component          !! 1 or 2
      real(c_double), intent(in) :: speed              !! [m/s]
      real(c_double), intent(in) :: start, duration    !! ramp [s]
      integer(c_int), intent(out) :: code
      character(len=256), intent(out) :: message

      type(status_type) :: status

      call check_handle(run, code, message)
      if (code /= ok) return
      call add_velocity(slots(run)%model, node, component, speed, ramp_type(start, duration), &
         status)
      call export_status(status, code, message)
   end subroutine run_add_velocity

   !> Follower pressure on edges.
   subroutine run_add_pressure(run, edge, n, pressure, stiffness, start, duration, code, message)
      integer(c_int), intent(in) :: run, n
      integer(c_int), intent(in) :: edge(2, n)         !! material on the left
      real(c_double), intent(in) :: pressure           !! [Pa]
      real(c_double), intent(in) :: stiffness          !! [Pa/m]
      real(c_double), intent(in) :: start, duration    !! ramp [s]
      integer(c_int), intent(out) :: code
      character(len=256), intent(out) :: message

      type(status_type) :: status

      call check_handle(run, code, message)
      if (code /= ok) return
      call add_pressure(slots(run)%model, edge, pressure, stiffness, ramp_type(start, duration), &
         status)
      call export_status(status, code, message)
   end subroutine run_add_pressure

   !> Let the boundary touch itself, with friction by surface tag; bodies are the first tags.
   subroutine run_add_contact(run, friction, n_tags, tolerance, code, message)
      integer(c_int), intent(in) :: run, n_tags
      real(c_double), intent(in) :: friction(n_tags, n_tags)
      real(c_double), intent(in) :: tolerance          !! over the usual one
      integer(c_int), intent(out) :: code
      character(len=256), intent(out) :: message

      type(status_type) :: status

      call check_handle(run, code, message)
      if (code /= ok) return
      call add_contact(slots(run)%model, friction, tolerance, status)
      call export_status(status, code, message)
   end subroutine run_add_contact

   !> Fail if parts share some of the plane, whether contact would keep them apart or not.
   subroutine run_refuse_overlap(run, code, message)
      integer(c_int), intent(in) :: run
      integer(c_int), intent(out) :: code
      character(len=256), intent(out) :: message

      type(status_type) :: status

      call check_handle(run, code, message)
      if (code /= ok) return
      associate (model => slots(run)%model)
         call refuse_overlap(model%mesh, model%fields%u, model%origin, "mesh", status)
      end associate
      call export_status(status, code, message)
   end subroutine run_refuse_overlap

   !> Give some edges of the boundary the surface tag `tag`.
   subroutine run_tag_surface(run, edge, n, tag, code, message)
      integer(c_int), intent(in) :: run, n
      integer(c_int), intent(in) :: edge(2, n)         !! material on the left
      integer(c_int), intent(in) :: tag
      integer(c_int), intent(out) :: code
      character(len=256), intent(out) :: message

      type(status_type) :: status

      call check_handle(run, code, message)
      if (code /= ok) return
      call tag_surface(slots(run)%model, edge, tag, status)
      call export_status(status, code, message)
   end subroutine run_tag_surface

   !> Let bodies crack, after loads, contact and tags.
   subroutine run_add_fracture(run, mode, weights, release_steps, reset, interval, least_factor, &
         code, message)
      integer(c_int), intent(in) :: run
      integer(c_int), intent(in) :: mode               !! as `fracture/arms`
      integer(c_int), intent(in) :: weights            !! as `fracture/failure_map`
      integer(c_int), intent(in) :: release_steps      !! -1: by the length of the crack
      integer(c_int), intent(in) :: reset              !! as `fracture/element_failure`
      integer(c_int), intent(in) :: interval           !! steps between failure maps
      real(c_double), intent(in) :: least_factor       !! F_p from which a node cracks
      integer(c_int), intent(out) :: code
      character(len=256), intent(out) :: message

      type(status_type) :: status

      call check_handle(run, code, message)
      if (code /= ok) return
      call add_fracture(slots(run)%model, mode, weights, release_steps, reset, interval, &
         least_factor, status)
      call export_status(status, code, message)
   end subroutine run_add_fracture

   !> Displacement and velocity at time 0.
   subroutine run_set_motion(run, u, v, n_nodes, code, message)
      integer(c_int), intent(in) :: run, n_nodes
      real(c_double), intent(in) :: u(2, n_nodes)      !! [m]
      real(c_double), intent(in) :: v(2, n_nodes)      !! [m/s]
      integer(c_int), intent(out) :: code
      character(len=256), intent(out) :: message

      type(status_type) :: status

      call check_handle(run, code, message)
      if (code /= ok) return
      call set_motion(slots(run)%model, u, v, status)
      call export_status(status, code, message)
   end subroutine run_set_motion

   !> Take `n_steps` steps; the interpreter lock is free meanwhile.
   subroutine run_advance(run, n_steps, threads, code, message)
      !f2py threadsafe
      integer(c_int), intent(in) :: run, n_steps, threads
      integer(c_int), intent(out) :: code
      character(len=256), intent(out) :: message

      type(status_type) :: status

      call check_handle(run, code, message)
      if (code /= ok) return
      call advance(slots(run)%model, n_steps, threads, status)
      call export_status(status, code, message)
   end subroutine run_advance

   !> Step, its length, the exact element limit, and the element that sets it.
   subroutine run_clock(run, step, dt, critical, element, code, message)
      integer(c_int), intent(in) :: run
      integer(c_int), intent(out) :: step
      real(c_double), intent(out) :: dt                !! [s]
      real(c_double), intent(out) :: critical          !! [s]
      integer(c_int), intent(out) :: element
      integer(c_int), intent(out) :: code
      character(len=256), intent(out) :: message

      step = 0
      dt = 0.0_c_double
      critical = 0.0_c_double
      element = 0
      call check_handle(run, code, message)
      if (code /= ok) return
      step = slots(run)%model%step
      dt = slots(run)%model%dt
      critical = slots(run)%model%critical
      element = slots(run)%model%critical_element
   end subroutine run_clock

   !> The ledger: kinetic, elastic, compressive, fracture, external, damping [J], residual
   !> (relative), initial, contact, friction, insertion, relump, reset, turning [J].
   subroutine run_energy(run, values, code, message)
      integer(c_int), intent(in) :: run
      real(c_double), intent(out) :: values(14)
      integer(c_int), intent(out) :: code
      character(len=256), intent(out) :: message

      type(ledger_type) :: ledger

      values = 0.0_c_double
      call check_handle(run, code, message)
      if (code /= ok) return
      call energy_now(slots(run)%model, ledger)
      values = pack_ledger(ledger)
   end subroutine run_energy

   !> What the guards look at: smallest area, largest speed, smallest step, deepest overlap. Places:
   !> element, node, element, then node and element of the overlap, bad node, bad element.
   subroutine run_watch(run, values, places, code, message)
      integer(c_int), intent(in) :: run
      real(c_double), intent(out) :: values(4)         !! all relative, see `sight_type`
      integer(c_int), intent(out) :: places(7)         !! 0: none
      integer(c_int), intent(out) :: code
      character(len=256), intent(out) :: message

      type(sight_type) :: sight

      values = 0.0_c_double
      places = 0
      call check_handle(run, code, message)
      if (code /= ok) return
      call look(slots(run)%model, sight)
      values = [sight%area, sight%speed, sight%step, sight%overlap]
      places = [sight%area_element, sight%speed_node, sight%step_element, sight%overlap_node, &
         sight%overlap_element, sight%bad_node, sight%bad_element]
   end subroutine run_watch

   !> Force [N] and displacement [m] of every load: velocities first, then pressures.
   subroutine run_loads(run, n, records, code, message)
      integer(c_int), intent(in) :: run, n
      real(c_double), intent(out) :: records(2, n)
      integer(c_int), intent(out) :: code
      character(len=256), intent(out) :: message

      records = 0.0_c_double
      call check_handle(run, code, message)
      if (code == ok) call load_records(slots(run)%model, records)
   end subroutine run_loads

   !> State of some elements; rows as `element_state`.
   subroutine run_elements(run, elements, n, values, code, message)
      integer(c_int), intent(in) :: run, n
      integer(c_int), intent(in) :: elements(n)
      real(c_double), intent(out) :: values(17, n)
      integer(c_int), intent(out) :: code
      character(len=256), intent(out) :: message

      values = 0.0_c_double
      call check_handle(run, code, message)
      if (code == ok) call element_state(slots(run)%model, elements, values)
   end subroutine run_elements

   !> Displacement, and velocity of the half step after it.
   subroutine run_nodes(run, n_nodes, u, v, mass, code, message)
      integer(c_int), intent(in) :: run, n_nodes
      real(c_double), intent(out) :: u(2, n_nodes)     !! [m]
      real(c_double), intent(out) :: v(2, n_nodes)     !! [m/s]
      real(c_double), intent(out) :: mass(n_nodes)     !! [kg]
      integer(c_int), intent(out) :: code
      character(len=256), intent(out) :: message

      u = 0.0_c_double
      v = 0.0_c_double
      mass = 0.0_c_double
      call check_handle(run, code, message)
      if (code /= ok) return
      u = slots(run)%model%fields%u
      v = slots(run)%model%fields%v
      mass = slots(run)%model%fields%mass
   end subroutine run_nodes

   !> Nodes, elements (also those that were cut), opened edges; cracks, fallbacks, failed
   !> nodes that had no way for a crack, most resets of one element, pairs of now.
   subroutine run_sizes(run, sizes, code, message)
      integer(c_int), intent(in) :: run
      integer(c_int), intent(out) :: sizes(8)
      integer(c_int), intent(out) :: code
      character(len=256), intent(out) :: message

      sizes = 0
      call check_handle(run, code, message)
      if (code /= ok) return
      associate (model => slots(run)%model)
         sizes(:2) = [model%mesh%n_nodes, model%mesh%n_elements]
         if (model%contact%on) sizes(8) = model%contact%n_pairs
         if (.not. model%fracture%on) return
         associate (fracture => model%fracture)
            sizes(3:7) = [fracture%n_edges, fracture%n_cracks, fracture%n_fallbacks, &
               count(fracture%retry > 0.0_c_double), maxval(fracture%resets)]
         end associate
      end associate
   end subroutine run_sizes

   !> The mesh as cracks have left it; elements that were cut are marked.
   subroutine run_mesh(run, n_nodes, n_elements, nodes, triangles, body, alive, code, message)
      integer(c_int), intent(in) :: run, n_nodes, n_elements
      real(c_double), intent(out) :: nodes(2, n_nodes)         !! reference [m]
      integer(c_int), intent(out) :: triangles(3, n_elements)
      integer(c_int), intent(out) :: body(n_elements)
      integer(c_int), intent(out) :: alive(n_elements)         !! 0: it was cut
      integer(c_int), intent(out) :: code
      character(len=256), intent(out) :: message

      nodes = 0.0_c_double
      triangles = 0
      body = 0
      alive = 1
      call check_handle(run, code, message)
      if (code /= ok) return
      associate (model => slots(run)%model)
         nodes = model%mesh%nodes(:, :n_nodes) + spread(model%origin, 2, n_nodes)
         triangles = model%mesh%triangles(:, :n_elements)
         body = model%mesh%body(:n_elements)
         if (model%fracture%on) alive = merge(1, 0, model%fracture%topology%alive(:n_elements))
      end associate
   end subroutine run_mesh

   !> Lowest element of the part that each element hangs together with; 0 if it was cut.
   subroutine run_parts(run, n_elements, part, code, message)
      integer(c_int), intent(in) :: run, n_elements
      integer(c_int), intent(out) :: part(n_elements)
      integer(c_int), intent(out) :: code
      character(len=256), intent(out) :: message

      part = 1
      call check_handle(run, code, message)
      if (code /= ok) return
      associate (model => slots(run)%model)
         if (model%fracture%on) part = find_parts(model%mesh, model%fracture%topology)
      end associate
   end subroutine run_parts

   !> Failure factor F_k of every element (eq. 21), and how often it has been reset.
   subroutine run_failure(run, n_elements, factor, resets, code, message)
      integer(c_int), intent(in) :: run, n_elements
      real(c_double), intent(out) :: factor(n_elements)
      integer(c_int), intent(out) :: resets(n_elements)
      integer(c_int), intent(out) :: code
      character(len=256), intent(out) :: message

      real(c_double) :: normal(2, n_elements)

      factor = 0.0_c_double
      resets = 0
      call check_handle(run, code, message)
      if (code /= ok) return
      associate (model => slots(run)%model)
         call set_failure_factors(model%chunks, model%rocks, model%state, factor, normal)
         if (model%fracture%on) resets = model%fracture%resets(:n_elements)
      end associate
   end subroutine run_failure

   !> The record of opened edges; rows as in `fracture_type`.
   subroutine run_cracks(run, n_edges, record, code, message)
      integer(c_int), intent(in) :: run, n_edges
      real(c_double), intent(out) :: record(16, n_edges)
      integer(c_int), intent(out) :: code
      character(len=256), intent(out) :: message

      record = 0.0_c_double
      call check_handle(run, code, message)
      if (code /= ok .or. n_edges == 0) return
      record = slots(run)%model%fracture%record(:, :n_edges)
      associate (origin => slots(run)%model%origin)
         record(3:4, :) = record(3:4, :) + spread(origin, 2, n_edges)
         record(5:6, :) = record(5:6, :) + spread(origin, 2, n_edges)
      end associate
   end subroutine run_cracks

   !> Fail in words where an invariant of a mesh that cracks is broken.
   subroutine run_check(run, code, message)
      integer(c_int), intent(in) :: run
      integer(c_int), intent(out) :: code
      character(len=256), intent(out) :: message

      type(status_type) :: status

      call check_handle(run, code, message)
      if (code /= ok) return
      call check_model(slots(run)%model, status)
      call export_status(status, code, message)
   end subroutine run_check

   !> Contact force on every node at the time of the fields.
   subroutine run_contact_forces(run, n_nodes, force, code, message)
      integer(c_int), intent(in) :: run, n_nodes
      real(c_double), intent(out) :: force(2, n_nodes)  !! [N]
      integer(c_int), intent(out) :: code
      character(len=256), intent(out) :: message

      force = 0.0_c_double
      call check_handle(run, code, message)
      if (code == ok) force = slots(run)%model%fields%contact
   end subroutine run_contact_forces

   !> Most pairs, steps with pairs, sweeps, steps not converged, lists made; deepest penetration
   !> over the shortest edge.
   subroutine run_contact_statistics(run, counts, penetration, code, message)
      integer(c_int), intent(in) :: run
      integer(c_int), intent(out) :: counts(5)
      real(c_double), intent(out) :: penetration
      integer(c_int), intent(out) :: code
      character(len=256), intent(out) :: message

      counts = 0
      penetration = 0.0_c_double
      call check_handle(run, code, message)
      if (code /= ok) return
      associate (statistics => slots(run)%model%contact%statistics)
         counts = [statistics%pairs_max, statistics%steps, statistics%sweeps, &
            statistics%unconverged, statistics%lists]
         penetration = statistics%penetration
      end associate
   end subroutine run_contact_statistics

   !> Numbers in a checkpoint.
   subroutine run_checkpoint_size(run, n, code, message)
      integer(c_int), intent(in) :: run
      integer(c_int), intent(out) :: n
      integer(c_int), intent(out) :: code
      character(len=256), intent(out) :: message

      n = 0
      call check_handle(run, code, message)
      if (code == ok) n = checkpoint_size(slots(run)%model)
   end subroutine run_checkpoint_size

   !> The state, to the bit.
   subroutine run_save(run, n, buffer, code, message)
      integer(c_int), intent(in) :: run, n
      real(c_double), intent(out) :: buffer(n)
      integer(c_int), intent(out) :: code
      character(len=256), intent(out) :: message

      buffer = 0.0_c_double
      call check_handle(run, code, message)
      if (code == ok) call save_state(slots(run)%model, buffer)
   end subroutine run_save

   !> Go on from a saved state of the same problem.
   subroutine run_restore(run, buffer, n, code, message)
      integer(c_int), intent(in) :: run, n
      real(c_double), intent(in) :: buffer(n)
      integer(c_int), intent(out) :: code
      character(len=256), intent(out) :: message

      type(status_type) :: status

      call check_handle(run, code, message)
      if (code /= ok) return
      call restore(slots(run)%model, buffer, status)
      call export_status(status, code, message)
   end subroutine run_restore

   subroutine check_handle(run, code, message)
      integer(c_int), intent(in) :: run
      integer(c_int), intent(out) :: code
      character(len=*), intent(out) :: message

      code = bad_input
      message = "no such run"
      if (run < 1 .or. run > max_runs) return
      if (.not. allocated(slots(run)%model)) return
      code = ok
      message = ""
   end subroutine check_handle

   subroutine export_status(status, code, message)
      type(status_type), intent(in) :: status
      integer(c_int), intent(out) :: code
      character(len=*), intent(out) :: message

      code = status%code
      message = ""
      if (allocated(status%message)) message = status%message
   end subroutine export_status

end module run_face
