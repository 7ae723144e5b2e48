!> What a user may turn, apart from mesh, materials and loads.
module lithofrac_run_settings
   use lithofrac_base_kinds, only: wp
   implicit none
   private

   public :: settings_type, no_damping, relative_to_affine, relative_to_ground

   integer, parameter :: no_damping = 0
   integer, parameter :: relative_to_affine = 1  !! each body against its own affine motion
   integer, parameter :: relative_to_ground = 2  !! eq. 3 to the letter

   type :: settings_type
      real(wp) :: time_step_factor = 0.9_wp      !! of the exact element limit
      integer :: damping = no_damping
      real(wp) :: damping_fraction = 0.0_wp      !! of critical of the lowest frequency
      real(wp) :: damping_alpha = -1.0_wp        !! fixed alpha [1/s]; negative: Rayleigh quotient
   end type settings_type

end module lithofrac_run_settings
