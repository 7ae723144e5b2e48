!> One element on its own, for tests: the same kernels as a run, without time and mass.
module kernels_mechanics
   use, intrinsic :: iso_c_binding, only: c_double, c_int
   use lithofrac_base_status, only: no_return_map, ok, set_failure, status_type
   use lithofrac_material_rock, only: new_rock, rock_type
   use lithofrac_mechanics_internal_force, only: chunk_force, failure_type
   use lithofrac_run_model, only: model_type, new_model
   use lithofrac_run_observe, only: element_state, n_element_state
   use lithofrac_run_settings, only: settings_type
   implicit none
   private

   public :: element_path

contains

   !> Lead a triangle through given displacements; state and nodal forces after each.
   subroutine element_path(nodes, axisymmetric, constants, table, n_knots, options, band_width, &
         path, n_steps, states, forces, dissipated, critical, code, message)
      integer(c_int), intent(in) :: n_knots, n_steps
      real(c_double), intent(in) :: nodes(2, 3)                  !! [m]
      integer(c_int), intent(in) :: axisymmetric                 !! 0 or 1
      real(c_double), intent(in) :: constants(5)                 !! as `new_rock`
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
         axisymmetric /= 0, rock, [band_width], settings_type(), status)
      if (status%code == ok) then
         critical = model%critical
         do step = 1, n_steps
            model%fields%v = path(:, :, step) - model%fields%u
            model%fields%u = path(:, :, step)
            call chunk_force(model%chunks, 1, model%rocks(1), model%fields, 1.0_c_double, &
               model%state, 0, forces(:, :, step), failure)
            call element_state(model, [1], states(:n_element_state, step:step))
         end do
         dissipated = model%state%dissipated(1, :, 1)
         if (failure%code /= ok) call set_failure(status, no_return_map, "no consistent return")
      end if
      code = status%code
      message = ""
      if (allocated(status%message)) message = status%message
   end subroutine element_path

end module kernels_mechanics
