!> How every procedure of this library says that it could not do its work.
module lithofrac_base_status
   implicit none
   private

   public :: status_type, set_failure
   public :: ok, bad_input, no_return_map, not_finite, bad_element, bad_checkpoint, bad_contact

   integer, parameter :: ok = 0
   integer, parameter :: bad_input = 1       !! a value that makes no sense
   integer, parameter :: no_return_map = 2   !! no consistent return of a trial stress
   integer, parameter :: not_finite = 3      !! NaN or infinity in a field
   integer, parameter :: bad_element = 4     !! area not positive
   integer, parameter :: bad_checkpoint = 5  !! state does not fit the model
   integer, parameter :: bad_contact = 6     !! bodies that cannot be kept apart

   !> Outcome of a call: `code == ok`, or a code above with words for a person.
   type :: status_type
      integer :: code = ok
      character(len=:), allocatable :: message
   end type status_type

contains

   !> Record a failure; the caller returns at once afterwards.
   pure subroutine set_failure(status, code, message)
      type(status_type), intent(out) :: status
      integer, intent(in) :: code
      character(len=*), intent(in) :: message

      status%code = code
      status%message = message
   end subroutine set_failure

end module lithofrac_base_status
