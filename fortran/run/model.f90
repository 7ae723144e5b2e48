!> One simulation: everything that is needed to take a step or to save a run.
module lithofrac_run_model
   use lithofrac_base_kinds, only: pi, wp
   use lithofrac_base_status, only: bad_input, ok, set_failure, status_type
   use lithofrac_contact_contact, only: contact_type, new_contact
   use lithofrac_contact_overlap, only: refuse_overlap
   use lithofrac_contact_surfaces, only: tag_edges
   use lithofrac_fracture_arms, only: intra_element
   use lithofrac_fracture_fracture, only: fracture_type, new_fracture
   use lithofrac_material_rock, only: rock_type
   use lithofrac_mechanics_blocks, only: blocks_type, new_blocks
   use lithofrac_mechanics_chunks, only: chunks_type, new_chunks
   use lithofrac_mechanics_fields, only: fields_type, free_all, inelastic_type, new_fields, &
      new_inelastic, prescribe
   use lithofrac_mechanics_loads, only: measure_edges, pressure_type, ramp_type, velocity_type
   use lithofrac_mechanics_lumped_mass, only: corner_masses
   use lithofrac_mesh_edge_set, only: find_edges
   use lithofrac_mesh_mesh, only: mesh_type, new_mesh, triangle_area
   use lithofrac_run_damping, only: affine_type, n_moments
   use lithofrac_run_energy, only: ledger_type
   use lithofrac_run_node_update, only: n_sums
   use lithofrac_run_settings, only: settings_type
   use lithofrac_run_time_step, only: critical_step
   implicit none
   private

   public :: add_contact, add_fracture, add_pressure, add_velocity, model_type, new_model
   public :: set_mass, set_motion, tag_surface

   real(wp), parameter :: alike = 10.0_wp    !! ratio of densities that contact hardly notices
   real(wp), parameter :: finest = 0.01_wp   !! tolerance for any ratio, over the usual one

   real(wp), parameter :: far = 100.0_wp     !! from the origin, over the size of the model
   real(wp), parameter :: fast = 3.0e-5_wp   !! speed over that of pressure waves: turns count

   type :: model_type
      type(mesh_type) :: mesh                             !! positions are relative to `origin`
      real(wp) :: origin(2) = 0.0_wp                      !! [m]
      type(chunks_type) :: chunks
      type(blocks_type) :: blocks
      type(rock_type), allocatable :: rocks(:)            !! (n_bodies)
      type(fields_type) :: fields
      type(inelastic_type) :: state
      type(velocity_type), allocatable :: velocities(:)
      type(pressure_type), allocatable :: pressures(:)
      type(contact_type) :: contact
      type(fracture_type) :: fracture
      integer, allocatable :: tag_nodes(:, :)             !! (2, n) edges with a surface tag
      integer, allocatable :: tagged(:, :)                !! (2, n) their elements and sides
      integer, allocatable :: tags(:)                     !! (n)
      type(settings_type) :: settings
      type(ledger_type) :: ledger
      real(wp) :: dt = 0.0_wp                             !! [s]
      real(wp) :: critical = 0.0_wp                       !! smallest exact element limit [s]
      integer :: critical_element = 0
      real(wp) :: fast_energy = 0.0_wp                    !! kinetic, above it turns are booked [J]
      integer :: fast_until = -1                          !! step up to which they are
      integer :: step = 0                                 !! fields are at time step*dt
      logical :: started = .false.                        !! forces of the state are known
      real(wp), allocatable :: lowest_frequency(:)        !! (n_bodies) estimate [1/s]
      real(wp), allocatable :: alpha(:)                   !! (n_bodies) damping [1/s]
      type(affine_type), allocatable :: affine(:)         !! (n_bodies)
      real(wp), allocatable :: moments(:, :)              !! (n_moments, n_runs)
      real(wp), allocatable :: sums(:, :)                 !! (n_sums, n_runs + 1) last: by contact
      integer :: reference_step = -1                      !! step of the state below, -1: none
      real(wp), allocatable :: reference_u(:, :)          !! state of the last Rayleigh quotient
      real(wp), allocatable :: reference_f(:, :)
   end type model_type

contains

   !> Build a model at rest.
   subroutine new_model(model, nodes, triangles, body, axisymmetric, rocks, band_factor, &
         settings, status)
      type(model_type), intent(out) :: model
      real(wp), intent(in) :: nodes(:, :)       !! (2, n_nodes) [m]
      integer, intent(in) :: triangles(:, :)    !! (3, n_elements)
      integer, intent(in) :: body(:)            !! (n_elements)
      logical, intent(in) :: axisymmetric
      type(rock_type), intent(in) :: rocks(:)   !! (n_bodies)
      real(wp), intent(in) :: band_factor(:)    !! (n_bodies) crack band width is sqrt(factor area)
      type(settings_type), intent(in) :: settings
      type(status_type), intent(out) :: status

      call new_mesh(model%mesh, nodes, triangles, body, status)
      if (status%code /= ok) return
      if (size(rocks) /= model%mesh%n_bodies) then
         call set_failure(status, bad_input, "model: one material a body is needed")
         return
      end if
      if (axisymmetric .and. any(nodes(1, :) < 0.0_wp)) then
         call set_failure(status, bad_input, "model: a radius is negative")
         return
      end if
      model%origin = origin_of(nodes, axisymmetric)
      if (any(abs(model%origin) > 0.0_wp)) model%mesh%nodes = nodes &
         - spread(model%origin, 2, size(nodes, 2))
      model%rocks = rocks
      model%settings = settings
      call new_chunks(model%chunks, model%mesh, axisymmetric, &
         spread(.true., 1, model%mesh%n_elements))
      call new_blocks(model%blocks, model%chunks, model%mesh)
      call new_fields(model%fields, model%mesh%n_nodes)
      call new_inelastic(model%state, model%chunks, model%rocks, &
         band_widths(model%mesh, band_factor))
      allocate (model%velocities(0), model%pressures(0), model%tag_nodes(2, 0), model%tags(0))
      allocate (model%affine(model%mesh%n_bodies))
      allocate (model%alpha(model%mesh%n_bodies), source=max(0.0_wp, settings%damping_alpha))
      allocate (model%moments(n_moments, model%blocks%n_runs), source=0.0_wp)
      allocate (model%sums(n_sums, model%blocks%n_runs + 1), source=0.0_wp)
      call set_mass(model)
      call set_time_step(model)
      call set_frequencies(model)
      call set_fast_energy(model)
   end subroutine new_model

   !> Where positions are counted from [m]: the middle of a model that stands far away, else 0.
   !>
   !> Squares of positions, as the fit of the damping sums them, would lose its shape.
   pure function origin_of(nodes, axisymmetric) result(origin)
      real(wp), intent(in) :: nodes(:, :)        !! (2, n_nodes) [m]
      logical, intent(in) :: axisymmetric        !! a radius stays what it is
      real(wp) :: origin(2)

      real(wp) :: low(2), high(2)

      low = minval(nodes, dim=2)
      high = maxval(nodes, dim=2)
      origin = 0.5_wp*(low + high)
      where (abs(origin) <= far*maxval(high - low)) origin = 0.0_wp
      if (axisymmetric) origin(1) = 0.0_wp
   end function origin_of

   !> Crack band width of every element [m].
   pure function band_widths(mesh, factor) result(width)
      type(mesh_type), intent(in) :: mesh
      real(wp), intent(in) :: factor(:)          !! (n_bodies)
      real(wp) :: width(mesh%n_elements)

      integer :: element

      do element = 1, mesh%n_elements
         associate (corner => mesh%triangles(:, element))
            width(element) = sqrt(factor(mesh%body(element))*triangle_area( &
               mesh%nodes(:, corner(1)), mesh%nodes(:, corner(2)), mesh%nodes(:, corner(3))))
         end associate
      end do
   end function band_widths

   !> Lumped masses, all components free.
   subroutine set_mass(model)
      type(model_type), intent(inout) :: model

      integer :: element

      model%fields%mass = spread(0.0_wp, 1, model%mesh%n_nodes)
      do element = 1, model%mesh%n_elements
         if (model%fracture%on) then
            if (.not. model%fracture%topology%alive(element)) cycle
         end if
         associate (corner => model%mesh%triangles(:, element))
            model%fields%mass(corner) = model%fields%mass(corner) + corner_masses(model%mesh, &
               element, model%rocks(model%mesh%body(element))%density, model%chunks%axisymmetric)
         end associate
      end do
      call free_all(model%fields)
   end subroutine set_mass

   subroutine set_time_step(model)
      type(model_type), intent(inout) :: model

      integer :: element
      real(wp) :: dt

      model%critical = huge(1.0_wp)
      do element = 1, model%mesh%n_elements
         dt = critical_step(model%mesh, model%chunks, element, &
            model%rocks(model%mesh%body(element)))
         if (dt >= model%critical) cycle
         model%critical = dt
         model%critical_element = element
      end do
      model%dt = model%settings%time_step_factor*model%critical
   end subroutine set_time_step

   !> Kinetic energy of the body that has least, at a speed that is fast: slower motion is not
   !> worth the look at every element twice a step that its turns take.
   subroutine set_fast_energy(model)
      type(model_type), intent(inout) :: model

      real(wp) :: modulus(model%mesh%n_bodies), energy(model%mesh%n_bodies)
      integer :: chunk

      modulus = model%rocks%lame + 2.0_wp*model%rocks%shear
      energy = 0.0_wp
      do chunk = 1, model%chunks%n_chunks
         associate (body => model%chunks%body(chunk))
            energy(body) = energy(body) + 0.5_wp*fast**2*modulus(body) &
               *sum(model%chunks%volume(:, chunk))
         end associate
      end do
      model%fast_energy = minval(energy)
   end subroutine set_fast_energy

   !> Lowest frequency of a bar as long as the body, held at one end: a floor of the quotient.
   subroutine set_frequencies(model)
      type(model_type), intent(inout) :: model

      integer :: body, k
      real(wp) :: extent(2)

      allocate (model%lowest_frequency(model%mesh%n_bodies))
      do body = 1, model%mesh%n_bodies
         do k = 1, 2
            extent(k) = maxval(model%mesh%nodes(k, :), model%mesh%body_of_node == body) &
               - minval(model%mesh%nodes(k, :), model%mesh%body_of_node == body)
         end do
         associate (rock => model%rocks(body))
            model%lowest_frequency(body) = &
               0.5_wp*pi*sqrt(rock%young/rock%density)/maxval(extent)
         end associate
      end do
   end subroutine set_frequencies

   !> Prescribe one velocity component of some nodes.
   subroutine add_velocity(model, node, component, speed, ramp, status)
      type(model_type), intent(inout) :: model
      integer, intent(in) :: node(:)
      integer, intent(in) :: component      !! 1 or 2
      real(wp), intent(in) :: speed         !! [m/s]
      type(ramp_type), intent(in) :: ramp
      type(status_type), intent(out) :: status

      type(velocity_type) :: load

      if (component < 1 .or. component > 2) then
         call set_failure(status, bad_input, "velocity: the component is 1 or 2")
      else if (any(node < 1) .or. any(node > model%mesh%n_nodes) .or. size(node) == 0) then
         call set_failure(status, bad_input, "velocity: a node does not exist")
      else if (any(model%fields%free_mass(component, node) <= 0.0_wp)) then
         call set_failure(status, bad_input, "velocity: a component is prescribed twice")
      else
         load%node = node
         load%component = component
         load%speed = speed
         load%ramp = ramp
         allocate (load%before(size(node)), source=0.0_wp)
         call prescribe(model%fields, component, node)
         model%velocities = [model%velocities, load]
      end if
   end subroutine add_velocity

   !> Load edges by a follower pressure.
   subroutine add_pressure(model, edge, pressure, stiffness, ramp, status)
      type(model_type), intent(inout) :: model
      integer, intent(in) :: edge(:, :)     !! (2, n) nodes, material on the left
      real(wp), intent(in) :: pressure      !! [Pa]
      real(wp), intent(in) :: stiffness     !! [Pa/m] of outward displacement
      type(ramp_type), intent(in) :: ramp
      type(status_type), intent(out) :: status

      type(pressure_type) :: load

      if (any(edge < 1) .or. any(edge > model%mesh%n_nodes) .or. size(edge) == 0) then
         call set_failure(status, bad_input, "pressure: an edge names a node that does not exist")
         return
      end if
      load%edge = edge
      load%pressure = pressure
      load%stiffness = stiffness
      load%ramp = ramp
      allocate (load%force(2, 2, size(edge, 2)), source=0.0_wp)
      call measure_edges(load, model%mesh%nodes, model%chunks%axisymmetric)
      model%pressures = [model%pressures, load]
   end subroutine add_pressure

   !> Let the boundary touch itself; what is overlapped from the start is refused.
   subroutine add_contact(model, friction, tolerance, status)
      type(model_type), intent(inout) :: model
      real(wp), intent(in) :: friction(:, :)   !! by surface tag; bodies are the first tags
      real(wp), intent(in) :: tolerance        !! of sweeps and penetration, over the usual one
      type(status_type), intent(out) :: status

      if (model%started) then
         call set_failure(status, bad_input, "contact: the run has started")
         return
      end if
      call new_contact(model%contact, model%mesh, friction, min(tolerance, &
         needed_tolerance(model%rocks)), status)
      if (status%code == ok) call refuse_overlap(model%mesh, model%fields%u, model%origin, &
         "contact", status)
   end subroutine add_contact

   !> Tolerance of contact that bodies of these densities ask for, over the usual one.
   !>
   !> Light nodes between heavy ones pass an impulse on and on, so that sweeps converge slowly:
   !> what the usual tolerance leaves of it shakes the light body, and contact gives energy. At a
   !> ratio of 1000 that came to 1.2 % of the work (test_contact_impact).
   pure function needed_tolerance(rocks) result(tolerance)
      type(rock_type), intent(in) :: rocks(:)
      real(wp) :: tolerance

      tolerance = alike*minval(rocks%density)/maxval(rocks%density)
      tolerance = max(finest, min(1.0_wp, tolerance))
   end function needed_tolerance

   !> Give some edges of the boundary a surface tag of their own, after `add_contact`.
   subroutine tag_surface(model, edge, tag, status)
      type(model_type), intent(inout) :: model
      integer, intent(in) :: edge(:, :)        !! (2, n) nodes, material on the left
      integer, intent(in) :: tag
      type(status_type), intent(out) :: status

      if (.not. model%contact%on .or. model%started) then
         call set_failure(status, bad_input, "contact: tag surfaces between contact and the start")
      else if (tag < 1 .or. tag > size(model%contact%friction, 1)) then
         call set_failure(status, bad_input, "contact: a surface has no friction")
      else
         call tag_edges(model%contact%surfaces, edge, tag, status)
         model%tag_nodes = reshape([model%tag_nodes, edge], [2, size(model%tags) + size(edge, 2)])
         model%tags = [model%tags, spread(tag, 1, size(edge, 2))]
      end if
   end subroutine tag_surface

   !> Let bodies crack, after loads, contact and tags.
   subroutine add_fracture(model, mode, weights, release_steps, reset, interval, least_factor, &
         status)
      type(model_type), intent(inout) :: model
      integer, intent(in) :: mode              !! as `fracture/arms`
      integer, intent(in) :: weights           !! as `fracture/failure_map`
      integer, intent(in) :: release_steps     !! -1: by the length of the crack
      integer, intent(in) :: reset             !! as `fracture/element_failure`
      integer, intent(in) :: interval          !! steps between failure maps
      real(wp), intent(in) :: least_factor     !! F_p from which a node cracks
      type(status_type), intent(out) :: status

      integer :: i

      if (.not. model%contact%on .or. model%chunks%axisymmetric .or. model%started) then
         call set_failure(status, bad_input, &
            "fracture: needs contact and plane strain, and comes before the start")
         return
      end if
      call new_fracture(model%fracture, model%mesh, model%rocks%poisson, mode, weights, &
         release_steps, reset, interval, least_factor, status)
      if (status%code /= ok) return
      associate (topology => model%fracture%topology)
         model%tagged = find_edges(model%mesh, topology, model%tag_nodes)
         do i = 1, size(model%pressures)
            associate (load => model%pressures(i))
               load%held = find_edges(model%mesh, topology, load%edge)
               if (all(load%held > 0)) cycle
               call set_failure(status, bad_input, &
                  "fracture: pressure acts on an edge that is not on the boundary")
            end associate
         end do
      end associate
      if (mode /= intra_element) return
      ! What the guard of cuts promises holds from the start, so no step ever has to change.
      model%critical = model%fracture%rules%guard%least_step*model%critical
      model%dt = model%settings%time_step_factor*model%critical
   end subroutine add_fracture

   !> Start from given displacements and velocities at time 0.
   subroutine set_motion(model, u, v, status)
      type(model_type), intent(inout) :: model
      real(wp), intent(in) :: u(:, :)       !! (2, n_nodes) [m]
      real(wp), intent(in) :: v(:, :)       !! (2, n_nodes) [m/s]
      type(status_type), intent(out) :: status

      if (model%started) then
         call set_failure(status, bad_input, "motion: the run has started")
         return
      end if
      model%fields%u = u
      model%fields%v = v
   end subroutine set_motion

end module lithofrac_run_model
