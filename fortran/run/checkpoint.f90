!> Save and restore a run to the bit.
!>
!> One list of arrays serves counting, saving and restoring, so the three cannot drift apart.
!> What follows from the problem (mesh, mass, step, constants) is not saved but built again.
module lithofrac_run_checkpoint
   use lithofrac_base_kinds, only: wp
   use lithofrac_base_status, only: bad_checkpoint, set_failure, status_type
   use lithofrac_contact_contact, only: contact_type, prepare_list
   use lithofrac_contact_surfaces, only: update_shape
   use lithofrac_run_contact_step, only: bring_masses
   use lithofrac_run_model, only: model_type
   implicit none
   private

   public :: checkpoint_size, restore, save_state

   integer, parameter :: counting = 0, saving = 1, restoring = 2

   type :: visitor_type
      integer :: mode = counting
      integer :: place = 0
      real(wp), allocatable :: buffer(:)
   contains
      procedure :: visit
      procedure :: visit_scalar
      procedure :: visit_count
      procedure :: visit_flags
   end type visitor_type

contains

   !> Numbers in a checkpoint of this model.
   function checkpoint_size(model) result(n)
      type(model_type), intent(inout) :: model
      integer :: n

      type(visitor_type) :: visitor

      call visit_model(visitor, model)
      n = visitor%place
   end function checkpoint_size

   !> Copy the state out.
   subroutine save_state(model, buffer)
      type(model_type), intent(inout) :: model
      real(wp), intent(out) :: buffer(:)   !! (checkpoint_size)

      type(visitor_type) :: visitor

      visitor%mode = saving
      allocate (visitor%buffer(size(buffer)))
      call visit_model(visitor, model)
      buffer = visitor%buffer
   end subroutine save_state

   !> Copy a saved state in; the model must have been built from the same problem.
   subroutine restore(model, buffer, status)
      type(model_type), intent(inout) :: model
      real(wp), intent(in) :: buffer(:)
      type(status_type), intent(out) :: status

      type(visitor_type) :: visitor

      visitor%mode = restoring
      visitor%buffer = buffer
      call visit_model(visitor, model)
      if (visitor%place /= size(buffer)) then
         call set_failure(status, bad_checkpoint, "checkpoint: it belongs to another model")
         return
      end if
      if (model%contact%on) call bring_masses(model)
      model%started = .true.
   end subroutine restore

   !> The one list of what a run remembers.
   subroutine visit_model(visitor, model)
      type(visitor_type), intent(inout) :: visitor
      type(model_type), intent(inout) :: model

      integer :: i

      call visitor%visit_count(model%step)
      call visitor%visit_flags(model%state%touched)
      call visitor%visit(size(model%fields%u), model%fields%u)
      call visitor%visit(size(model%fields%v), model%fields%v)
      call visitor%visit(size(model%fields%internal), model%fields%internal)
      call visitor%visit(size(model%fields%external), model%fields%external)
      associate (state => model%state)
         call visitor%visit(size(state%strain), state%strain)
         call visitor%visit(size(state%plastic_strain), state%plastic_strain)
         call visitor%visit(size(state%ft), state%ft)
         call visitor%visit(size(state%opening), state%opening)
         call visitor%visit(size(state%axis), state%axis)
         call visitor%visit(size(state%crack), state%crack)
         call visitor%visit(size(state%sin_phi), state%sin_phi)
         call visitor%visit(size(state%c_cos_phi), state%c_cos_phi)
         call visitor%visit(size(state%dissipated), state%dissipated)
      end associate
      call visitor%visit(size(model%moments), model%moments)
      call visitor%visit(size(model%sums), model%sums)
      call visitor%visit(size(model%alpha), model%alpha)
      if (.not. allocated(model%reference_u)) then
         allocate (model%reference_u, source=model%fields%u)
         allocate (model%reference_f, source=model%fields%internal)
      end if
      call visitor%visit(size(model%reference_u), model%reference_u)
      call visitor%visit(size(model%reference_f), model%reference_f)
      call visitor%visit_scalar(model%ledger%initial)
      call visitor%visit_scalar(model%ledger%external)
      call visitor%visit_scalar(model%ledger%damping)
      call visitor%visit_scalar(model%ledger%scale)
      do i = 1, size(model%velocities)
         call visitor%visit(size(model%velocities(i)%before), model%velocities(i)%before)
         call visitor%visit_scalar(model%velocities(i)%now)
      end do
      do i = 1, size(model%pressures)
         call visitor%visit(size(model%pressures(i)%force), model%pressures(i)%force)
         call visitor%visit_scalar(model%pressures(i)%power_before)
      end do
      if (model%contact%on) call visit_contact(visitor, model)
   end subroutine visit_model

   !> Contact comes last: the length of its list is known only with the list.
   subroutine visit_contact(visitor, model)
      type(visitor_type), intent(inout) :: visitor
      type(model_type), intent(inout) :: model

      real(wp) :: listed

      call visitor%visit(size(model%fields%contact), model%fields%contact)
      call visitor%visit_scalar(model%ledger%contact)
      call visitor%visit_scalar(model%ledger%friction)
      associate (contact => model%contact)
         call visitor%visit(size(contact%work_before), contact%work_before)
         call visitor%visit(size(contact%work_after), contact%work_after)
         call visitor%visit(size(contact%candidates%u), contact%candidates%u)
         call visitor%visit(size(contact%tangent), contact%tangent)
         call visitor%visit_count(contact%statistics%pairs_max)
         call visitor%visit_count(contact%statistics%steps)
         call visitor%visit_count(contact%statistics%sweeps)
         call visitor%visit_count(contact%statistics%unconverged)
         call visitor%visit_count(contact%statistics%lists)
         call visitor%visit_scalar(contact%statistics%penetration)
         listed = merge(1.0_wp, 0.0_wp, contact%candidates%listed)
         call visitor%visit_scalar(listed)
         if (listed < 0.5_wp) return
         if (visitor%mode == restoring) call renew(contact)
         call visitor%visit(size(contact%corner_impulse), contact%corner_impulse)
         call visitor%visit(size(contact%edge_impulse), contact%edge_impulse)
      end associate
   end subroutine visit_contact

   !> The list of a saved run follows from the positions that it was made for.
   subroutine renew(contact)
      type(contact_type), intent(inout) :: contact

      contact%surfaces%u = contact%candidates%u
      call update_shape(contact%surfaces)
      call prepare_list(contact)
   end subroutine renew

   !> Count, save or restore `n` numbers.
   subroutine visit(self, n, values)
      class(visitor_type), intent(inout) :: self
      integer, intent(in) :: n
      real(wp), intent(inout) :: values(n)

      select case (self%mode)
      case (saving)
         self%buffer(self%place + 1:self%place + n) = values
      case (restoring)
         if (self%place + n <= size(self%buffer)) then
            values = self%buffer(self%place + 1:self%place + n)
         end if
      case default
         continue  ! counting only
      end select
      self%place = self%place + n
   end subroutine visit

   subroutine visit_scalar(self, value)
      class(visitor_type), intent(inout) :: self
      real(wp), intent(inout) :: value

      real(wp) :: one(1)

      one = value
      call self%visit(1, one)
      value = one(1)
   end subroutine visit_scalar

   subroutine visit_count(self, count)
      class(visitor_type), intent(inout) :: self
      integer, intent(inout) :: count

      real(wp) :: value

      value = count
      call self%visit_scalar(value)
      count = nint(value)
   end subroutine visit_count

   subroutine visit_flags(self, flags)
      class(visitor_type), intent(inout) :: self
      logical, intent(inout) :: flags(:)

      real(wp) :: values(size(flags))

      values = merge(1.0_wp, 0.0_wp, flags)
      call self%visit(size(flags), values)
      flags = values > 0.5_wp
   end subroutine visit_flags

end module lithofrac_run_checkpoint
