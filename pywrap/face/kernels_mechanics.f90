!> One element on its own, for tests: the same kernels as a run, without time and mass.
module kernels_mechanics
   use, intrinsic :: iso_c_binding, only: c_double, c_int
   use lithofrac_base_status, only: no_return_map, ok, set_failure, status_type
   use lithofrac_material_rock, only: new_rock, rock_type
   use lithofrac_mechanics_bare_kernel, only: bare_steps
   use lithofrac_mechanics_internal_force, only: chunk_force, failure_type
   use lithofrac_mesh_mesh, only: triangle_area
   use lithofrac_run_model, only: model_type, new_model
   use lithofrac_run_observe, only: element_state, n_element_state
   use lithofrac_run_settings, only: settings_type
   implicit none
   private

   public :: bare_elastic, element_path

contains

   !> Lead a triangle through given displacements; state and nodal forces after each.
   subroutine element_path(nodes, axisymmetric, constants, table, n_knots, options, band_width, &
         path, n_steps, states, forces, dissipated, critical, code, message)
      integer(c_int), intent(in) :: n_knots, n_steps
      real(c_double), intent(in) :: nodes(2, 3)                  !! [m]
      integer(c_int), intent(in) :: axisymmetric                 !! 0 or 1
      real(c_double), intent(in) :: constants(6)                 !! as `new_rock`
      real(c_double), intent(in) :: table(4, n_knots)
      integer(c_int), intent(in) :: options(4)
      real(c_double), intent(in) :: band_width                   !! [m]
      real(c_double), intent(in) :: path(2, 3, n_steps)          !! displacements [m]
      real(c_double), intent(out) :: states(17, n_steps)         !! rows as `element_state`
      real(c_double), intent(out) :: forces(2, 3, n_steps)       !! internal [N]
      real(c_double), intent(out) :: dissipated(2)               !! compressive, fracture [J/m3]
      real(c_double), intent(out) :: critical                    !! exact critical step [s]
      integer(c_int), intent(out) :: code
      character(len=256), intent(out) :: message

      type(model_type) :: model
      type(rock_type) :: rock(1)
      type(status_type) :: status
      type(failure_type) :: failure
      integer :: step

      states = 0.0_c_double
      forces = 0.0_c_double
      dissipated = 0.0_c_double
      critical = 0.0_c_double
      call new_rock(rock(1), constants, table, options, status)
      if (status%code == ok) call new_model(model, nodes, reshape([1, 2, 3], [3, 1]), [1], &
         axisymmetric /= 0, rock, [band_width**2/triangle_area(nodes(:, 1), nodes(:, 2), &
         nodes(:, 3))], settings_type(), status)
      if (status%code == ok) then
         critical = model%critical
         do step = 1, n_steps
            model%fields%v = path(:, :, step) - model%fields%u
            model%fields%u = path(:, :, step)
            call chunk_force(model%chunks, 1, model%rocks(1), model%fields, 1.0_c_double, &
               model%state, model%blocks%place(:, :, 1), size(forces, 2), &
               forces(:, :, step), failure)
            call element_state(model, [1], states(:n_element_state, step:step))
         end do
         dissipated = model%state%dissipated(1, :, 1)
         if (failure%code /= ok) call set_failure(status, no_return_map, "no consistent return")
      end if
      code = status%code
      message = ""
      if (allocated(status%message)) message = status%message
   end subroutine element_path

   !> Bare elastic steps of a free body: the yardstick of the benchmark.
   subroutine bare_elastic(nodes, n_nodes, triangles, n_elements, young, poisson, density, &
         velocity, n_steps, time_step_factor, moved, code, message)
      !f2py threadsafe
      integer(c_int), intent(in) :: n_nodes, n_elements, n_steps
      real(c_double), intent(in) :: nodes(2, n_nodes)            !! [m]
      integer(c_int), intent(in) :: triangles(3, n_elements)
      real(c_double), intent(in) :: young                        !! [Pa]
      real(c_double), intent(in) :: poisson
      real(c_double), intent(in) :: density                      !! [kg/m3]
      real(c_double), intent(in) :: velocity(2, n_nodes)         !! at the first half step [m/s]
      real(c_double), intent(in) :: time_step_factor
      real(c_double), intent(out) :: moved(2, n_nodes)           !! positions after the steps [m]
      integer(c_int), intent(out) :: code
      character(len=256), intent(out) :: message

      type(model_type) :: model
      type(rock_type) :: rock(1)
      type(status_type) :: status
      type(settings_type) :: settings
      real(c_double) :: no_table(4, 1)
      real(c_double), allocatable :: v(:, :)
      integer, allocatable :: body(:)

      no_table = 0.0_c_double
      moved = nodes
      settings%time_step_factor = time_step_factor
      allocate (body(n_elements), source=1)
      v = velocity
      call new_rock(rock(1), [young, poisson, density, 0.0_c_double, 0.0_c_double, &
         0.0_c_double], no_table, [0, 0, 1, 0], status)
      if (status%code == ok) call new_model(model, nodes, triangles, body, .false., rock, &
         [1.0_c_double], settings, status)
      if (status%code == ok) call bare_steps(model%chunks, rock(1)%lame, rock(1)%shear, &
         1.0_c_double/model%fields%mass, model%dt, n_steps, moved, v)
      code = status%code
      message = ""
      if (allocated(status%message)) message = status%message
   end subroutine bare_elastic

end module kernels_mechanics
