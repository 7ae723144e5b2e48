!> Number kinds and constants. Everything else builds on this module.
module lithofrac_base_kinds
   use, intrinsic :: iso_c_binding, only: c_double
   implicit none
   private

   public :: wp, pi

   integer, parameter :: wp = c_double  !! working precision of every real

   real(wp), parameter :: pi = acos(-1.0_wp)
end module lithofrac_base_kinds
