!> Slices of the work of a step, for threads; no bit depends on how many there are.
module lithofrac_contact_slices
   use lithofrac_base_kinds, only: wp
   implicit none
   private

   public :: group_type, last_of, most_groups, most_slices, slice_type, worth_threads

   integer, parameter :: most_slices = 8          !! of nodes or candidates
   integer, parameter :: most_groups = 64         !! of islands
   integer, parameter :: worth_threads = 500      !! candidates; waking a thread costs as much

   !> What one slice of the candidates has found in a step.
   type :: slice_type
      logical :: moved = .false.                  !! a node has left the skin of the list
      logical :: turned = .false.                 !! an edge has turned since corners were made
      integer :: collision = 0                    !! first pair that may not yield and meets
      real(wp) :: speed = 0.0_wp                  !! squared, of the fastest node [m2/s2]
      real(wp) :: fastest = 0.0_wp                !! relative velocity of a pair [m/s]
      real(wp) :: deepest = 0.0_wp                !! penetration of a pair [m]
      integer :: first(3) = 1                     !! pairs of each pass, into the pairs of the step
      integer :: last(3) = 0
   end type slice_type

   !> Some islands that are solved one after the other.
   type :: group_type
      integer :: first = 1                        !! into the order of the pairs
      integer :: last = 0
      integer :: sweeps = 0
      logical :: converged = .true.
      real(wp) :: work(4) = 0.0_wp                !! of its pairs, where it is the only group [J]
      integer :: too_fast = 0                     !! first pair that may jump over its faces
   end type group_type

contains

   !> Where one of `n_slices` slices of `n` things ends; slice 0 is empty.
   pure function last_of(n, slice, n_slices) result(last)
      integer, intent(in) :: n
      integer, intent(in) :: slice
      integer, intent(in) :: n_slices
      integer :: last

      last = (n/n_slices)*slice + (modulo(n, n_slices)*slice)/n_slices
   end function last_of

end module lithofrac_contact_slices
