!> Save and restore a run to the bit.
!>
!> One list of arrays serves counting, saving and restoring, so the three cannot drift apart.
!> What follows from the problem (mesh, mass, step, constants) is not saved but built again.
module lithofrac_run_checkpoint
   use lithofrac_base_growth, only: reserve
   use lithofrac_base_kinds, only: wp
   use lithofrac_base_status, only: bad_checkpoint, ok, set_failure, status_type
   use lithofrac_contact_contact, only: contact_type, prepare_list
   use lithofrac_contact_surfaces, only: update_shape
   use lithofrac_fracture_fracture, only: fracture_type, n_record
   use lithofrac_mechanics_loads, only: measure_edges
   use lithofrac_mesh_edge_set, only: edge_nodes
   use lithofrac_run_contact_step, only: bring_masses
   use lithofrac_run_grow, only: new_layout, rebuild
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
      procedure :: visit_counts
      procedure :: visit_columns
      procedure :: visit_flags
      procedure :: is_beyond
   end type visitor_type

contains

   !> Numbers in a checkpoint of this model.
   function checkpoint_size(model) result(n)
      type(model_type), intent(inout) :: model
      integer :: n

      type(visitor_type) :: visitor
      type(status_type) :: status

      call visit_model(visitor, model, status)
      n = visitor%place
   end function checkpoint_size

   !> Copy the state out.
   subroutine save_state(model, buffer)
      type(model_type), intent(inout) :: model
      real(wp), intent(out) :: buffer(:)   !! (checkpoint_size)

      type(visitor_type) :: visitor
      type(status_type) :: status

      visitor%mode = saving
      allocate (visitor%buffer(size(buffer)))
      call visit_model(visitor, model, status)
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
      call visit_model(visitor, model, status)
      if (status%code /= ok) return
      if (visitor%place /= size(buffer)) then
         call set_failure(status, bad_checkpoint, "checkpoint: it belongs to another model")
         return
      end if
      if (model%contact%on) call bring_masses(model)
      model%started = .true.
   end subroutine restore

   !> The one list of what a run remembers.
   subroutine visit_model(visitor, model, status)
      type(visitor_type), intent(inout) :: visitor
      type(model_type), intent(inout) :: model
      type(status_type), intent(out) :: status

      integer :: i

      call visitor%visit_count(model%step)
      if (model%fracture%on) call visit_mesh(visitor, model, status)
      if (status%code /= ok) return
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
         ! A piece of an element keeps the modulus of the whole, so this no longer follows.
         if (model%fracture%on) call visitor%visit(size(state%softening), state%softening)
      end associate
      call visitor%visit(size(model%moments), model%moments)
      do i = 1, size(model%affine)  ! which the moments are about
         call visitor%visit(2, model%affine(i)%centre)
      end do
      call visitor%visit(size(model%sums), model%sums)
      call visitor%visit(size(model%alpha), model%alpha)
      call visitor%visit_count(model%reference_step)
      if (model%reference_step >= 0) then
         if (visitor%mode == restoring) then
            model%reference_u = model%fields%u
            model%reference_f = model%fields%internal
         end if
         call visitor%visit(size(model%reference_u), model%reference_u)
         call visitor%visit(size(model%reference_f), model%reference_f)
      end if
      call visitor%visit_scalar(model%ledger%initial)
      call visitor%visit_scalar(model%ledger%external)
      call visitor%visit_scalar(model%ledger%damping)
      call visitor%visit_scalar(model%ledger%insertion)
      call visitor%visit_scalar(model%ledger%relump)
      call visitor%visit_scalar(model%ledger%reset)
      call visitor%visit_scalar(model%ledger%turning)
      call visitor%visit_count(model%fast_until)
      call visitor%visit_scalar(model%ledger%scale)
      do i = 1, size(model%velocities)
         call visitor%visit(size(model%velocities(i)%before), model%velocities(i)%before)
         call visitor%visit_scalar(model%velocities(i)%now)
      end do
      do i = 1, size(model%pressures)
         call visitor%visit(size(model%pressures(i)%force), model%pressures(i)%force)
         call visitor%visit_scalar(model%pressures(i)%power_before)
      end do
      if (model%fracture%on) call visit_fracture(visitor, model%fracture)
      if (model%contact%on) call visit_contact(visitor, model)
   end subroutine visit_model

   !> Mesh and topology first: all that follows has their size.
   subroutine visit_mesh(visitor, model, status)
      type(visitor_type), intent(inout) :: visitor
      type(model_type), intent(inout) :: model
      type(status_type), intent(out) :: status

      integer :: i, k, first_nodes, first_elements

      associate (mesh => model%mesh, topology => model%fracture%topology)
         first_nodes = size(model%fields%mass)
         first_elements = size(model%fracture%heir)
         call visitor%visit_count(mesh%n_nodes)
         call visitor%visit_count(mesh%n_elements)
         associate (n => mesh%n_nodes, m => mesh%n_elements)
            if (visitor%mode == restoring) then
               if (visitor%is_beyond(n*3 + m*8) .or. n < first_nodes .or. m < first_elements) then
                  call set_failure(status, bad_checkpoint, &
                     "checkpoint: it belongs to another model")
                  mesh%n_nodes = first_nodes
                  mesh%n_elements = first_elements
                  return
               end if
               call reserve(mesh%nodes, n)
               call reserve(mesh%triangles, m)
               call reserve(topology%neighbour, m)
               call reserve(topology%alive, m)
            end if
            call visitor%visit(2*n, mesh%nodes)
            call visitor%visit_columns(mesh%triangles, m)
            call visitor%visit_columns(topology%neighbour, m)
            call visitor%visit_flags(topology%alive(:m))
            call visitor%visit_counts(mesh%body, m)
            call visitor%visit_counts(mesh%body_of_node, n)
            call visitor%visit_counts(topology%element_at, n)
            call visitor%visit_counts(topology%origin, m)
            call visitor%visit_counts(model%fracture%heir, m)
            call visitor%visit_counts(model%fracture%resets, m)
         end associate
      end associate
      do i = 1, size(model%velocities)
         call visit_list(visitor, model%velocities(i)%node)
         if (visitor%mode == restoring) model%velocities(i)%before = &
            spread(0.0_wp, 1, size(model%velocities(i)%node))
      end do
      do i = 1, size(model%pressures)
         call visit_edges(visitor, model%pressures(i)%held)
         if (visitor%mode /= restoring) cycle
         associate (load => model%pressures(i))
            load%edge = edge_nodes(model%mesh, load%held)
            call measure_edges(load, model%mesh%nodes, .false.)
            load%force = reshape([(0.0_wp, k=1, 4*size(load%edge, 2))], &
               [2, 2, size(load%edge, 2)])
         end associate
      end do
      call visit_edges(visitor, model%tagged)
      call visit_list(visitor, model%tags)
      if (visitor%mode == restoring) call lay_out(model, status)
   end subroutine visit_mesh

   !> Elements that were cut have no lane of their own, so their state is never asked for.
   subroutine lay_out(model, status)
      type(model_type), intent(inout) :: model
      type(status_type), intent(out) :: status

      call new_layout(model)
      model%fields%u = spread([0.0_wp, 0.0_wp], 2, model%mesh%n_nodes)
      model%fields%v = model%fields%u
      call rebuild(model, status)
   end subroutine lay_out

   subroutine visit_fracture(visitor, fracture)
      type(visitor_type), intent(inout) :: visitor
      type(fracture_type), intent(inout) :: fracture

      integer :: i, n

      call visitor%visit_scalar(fracture%looked_at)
      call visitor%visit_count(fracture%n_waiting)
      call visitor%visit_count(fracture%n_cracks)
      call visitor%visit_count(fracture%n_fallbacks)
      call visitor%visit_count(fracture%n_edges)
      if (visitor%mode == restoring) then
         fracture%record = spread(spread(0.0_wp, 1, n_record), 2, fracture%n_edges)
         fracture%retry = spread(0.0_wp, 1, size(fracture%topology%element_at))
      end if
      call visitor%visit(n_record*fracture%n_edges, fracture%record)
      n = size(fracture%retry)
      call visitor%visit(n, fracture%retry)
      call visitor%visit_scalar(fracture%bonds%power_before)
      call visitor%visit(size(fracture%drag%force), fracture%drag%force)
      call visitor%visit_scalar(fracture%drag%power_before)
      n = size(fracture%bonds%list)
      call visitor%visit_count(n)
      if (visitor%mode == restoring) then
         deallocate (fracture%bonds%list)
         allocate (fracture%bonds%list(n))
      end if
      do i = 1, n
         associate (bond => fracture%bonds%list(i))
            call visitor%visit_count(bond%node)
            call visitor%visit_count(bond%begin)
            call visitor%visit_count(bond%length)
            call visitor%visit(2, bond%whole)
            call visitor%visit(2, bond%force)
         end associate
      end do
   end subroutine visit_fracture

   !> A list whose length is saved as well.
   subroutine visit_list(visitor, list)
      type(visitor_type), intent(inout) :: visitor
      integer, allocatable, intent(inout) :: list(:)

      integer :: n

      n = size(list)
      call visitor%visit_count(n)
      call visitor%visit_counts(list, n)
   end subroutine visit_list

   !> The same for a list of pairs of integers.
   subroutine visit_edges(visitor, edge)
      type(visitor_type), intent(inout) :: visitor
      integer, allocatable, intent(inout) :: edge(:, :)

      integer :: i, n

      n = size(edge, 2)
      call visitor%visit_count(n)
      if (visitor%mode == restoring) edge = reshape([(0, i=1, 2*n)], [2, n])
      call visitor%visit_columns(edge, n)
   end subroutine visit_edges

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
         if (listed < 0.5_wp) then
            call visit_pairs(visitor, contact%candidates%corner, contact%corner_impulse)
            call visit_pairs(visitor, contact%candidates%edge, contact%edge_impulse)
            return
         end if
         if (visitor%mode == restoring) call renew(contact)
         call visitor%visit(size(contact%corner_impulse), contact%corner_impulse)
         call visitor%visit(size(contact%edge_impulse), contact%edge_impulse)
      end associate
   end subroutine visit_contact

   !> Pairs of before cracks came: the next list takes their impulses as a first guess.
   subroutine visit_pairs(visitor, pair, impulse)
      type(visitor_type), intent(inout) :: visitor
      integer, allocatable, intent(inout) :: pair(:, :)
      real(wp), allocatable, intent(inout) :: impulse(:, :)

      if (.not. allocated(pair)) allocate (pair(2, 0), impulse(2, 0))
      call visit_edges(visitor, pair)
      if (visitor%mode == restoring) impulse = spread([0.0_wp, 0.0_wp], 2, size(pair, 2))
      call visitor%visit(size(impulse), impulse)
   end subroutine visit_pairs

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

   !> The first `n` integers of a list, which gets that length when restored.
   subroutine visit_counts(self, counts, n)
      class(visitor_type), intent(inout) :: self
      integer, allocatable, intent(inout) :: counts(:)
      integer, intent(in) :: n

      real(wp) :: values(n)

      if (self%mode /= restoring) values = counts(:n)
      call self%visit(n, values)
      if (self%mode == restoring) counts = nint(values)
   end subroutine visit_counts

   !> The first `n` columns of integers.
   subroutine visit_columns(self, columns, n)
      class(visitor_type), intent(inout) :: self
      integer, intent(inout) :: columns(:, :)   !! (k, >= n)
      integer, intent(in) :: n

      real(wp) :: values(size(columns, 1), n)

      if (self%mode /= restoring) values = columns(:, :n)
      call self%visit(size(values), values)
      if (self%mode == restoring) columns(:, :n) = nint(values)
   end subroutine visit_columns

   !> Does the buffer end before `n` more numbers?
   pure function is_beyond(self, n) result(yes)
      class(visitor_type), intent(in) :: self
      integer, intent(in) :: n
      logical :: yes

      yes = self%place + n > size(self%buffer)
   end function is_beyond

   subroutine visit_flags(self, flags)
      class(visitor_type), intent(inout) :: self
      logical, intent(inout) :: flags(:)

      real(wp) :: values(size(flags))

      values = merge(1.0_wp, 0.0_wp, flags)
      call self%visit(size(flags), values)
      flags = values > 0.5_wp
   end subroutine visit_flags

end module lithofrac_run_checkpoint
