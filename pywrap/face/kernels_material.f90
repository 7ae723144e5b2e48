!> Single kernels of the material point, for tests and for calibration.
module kernels_material
   use, intrinsic :: iso_c_binding, only: c_double, c_int
   use lithofrac_base_status, only: status_type
   implicit none
   private

   public :: kernel_version

contains

   !> Number of this face; proves that the extension loads.
   subroutine kernel_version(version)
      integer(c_int), intent(out) :: version

      version = 1
   end subroutine kernel_version

end module kernels_material
