!> Contact within a step of the run: motion in, corrected velocities and sums out.
!>
!> The node update has predicted velocities without contact. The correction also reaches what
!> the update has summed on its way: kinetic energy, power of the damping, moments.
module lithofrac_run_contact_step
   use lithofrac_base_kinds, only: wp
   use lithofrac_base_status, only: bad_contact, set_failure, status_type
   use lithofrac_contact_contact, only: find_groups, has_turned, turn_corners
   use lithofrac_contact_search, only: has_moved
   use lithofrac_contact_slices, only: last_of, most_groups, most_slices, &
      worth_threads
   use lithofrac_contact_solve, only: prescribed_collision, renew, solve_contact, solved, too_fast
   use lithofrac_contact_surfaces, only: update_edges
   use lithofrac_run_model, only: model_type
   use lithofrac_run_node_update, only: n_sums
   use lithofrac_run_settings, only: no_damping, relative_to_affine
   implicit none
   private

   public :: bring_masses, book_contact, close_contacts, note_velocities

contains

   !> Masses of the boundary nodes, once no load will change any more.
   subroutine bring_masses(model)
      type(model_type), intent(inout) :: model

      integer :: i

      associate (contact => model%contact)
         do i = 1, contact%surfaces%n
            contact%motion(i)%inverse_mass = model%fields%inverse_mass(:, contact%surfaces%node(i))
         end do
      end associate
   end subroutine bring_masses

   !> Keep the velocities of the half step that ends, and make room for the impulses of the next.
   pure subroutine note_velocities(model)
      type(model_type), intent(inout) :: model

      integer :: i

      associate (contact => model%contact)
         do i = 1, contact%surfaces%n
            associate (at => contact%record(i), node => contact%surfaces%node(i))
               at%before(1) = model%fields%v(1, node)
               at%before(2) = model%fields%v(2, node)
               at%impulse(1) = 0.0_wp
               at%impulse(2) = 0.0_wp
            end associate
         end do
      end associate
   end subroutine note_velocities

   !> Add the contact impulses of this step to the predicted velocities.
   !>
   !> Called by one thread; the others of its team take slices of the work.
   subroutine close_contacts(model, threads, status)
      type(model_type), intent(inout) :: model
      integer, intent(in) :: threads
      type(status_type), intent(out) :: status

      integer :: code, pair(2), slice
      logical :: threaded
      real(wp) :: sums(n_sums, most_slices)

      associate (contact => model%contact)
         threaded = threads > 1 .and. contact%surfaces%n > worth_threads
         contact%n_slices = merge(most_slices, 1, threaded)
         pair = 1
         code = solved
         !$omp taskloop default(shared) grainsize(1) if(threaded)
         do slice = 1, contact%n_slices
            call bring_positions(model, slice)
         end do
         !$omp end taskloop
         if (any(contact%slices(:contact%n_slices)%moved) .or. .not. contact%candidates%listed) then
            call renew(contact, code)
            if (code == solved) model%fields%contact(:, contact%surfaces%node) = 0.0_wp
         end if
         if (code == solved) then
            threaded = threads > 1 .and. size(contact%near) > worth_threads
            contact%n_slices = merge(most_slices, 1, threaded)
            if (contact%n_groups /= min(threads, most_groups)) call find_groups(contact, &
               min(threads, most_groups))
            !$omp taskloop default(shared) grainsize(1) if(threaded)
            do slice = 1, contact%n_slices
               call bring_velocities(model, slice)
            end do
            !$omp end taskloop
            if (any(contact%slices(:contact%n_slices)%turned)) call turn_corners(contact)
            call solve_contact(contact, model%dt, model%critical, threaded, code, pair)
         end if
         if (code /= solved) then
            call explain(model, code, contact%surfaces%node(pair), status)
            return
         end if
         !$omp taskloop default(shared) grainsize(1) if(threaded)
         do slice = 1, most_slices
            call take_impulses(model, slice, sums(:, slice))
         end do
         !$omp end taskloop
         model%sums(:, model%blocks%n_runs + 1) = sum(sums, dim=2)
      end associate
   end subroutine close_contacts

   !> Positions of a slice of the boundary nodes: has one of them moved too far for the list?
   pure subroutine bring_positions(model, slice)
      type(model_type), intent(inout) :: model
      integer, intent(in) :: slice

      integer :: i, first, last

      associate (surfaces => model%contact%surfaces, fields => model%fields)
         first = last_of(surfaces%n, slice - 1, model%contact%n_slices) + 1
         last = last_of(surfaces%n, slice, model%contact%n_slices)
         do i = first, last
            surfaces%u(1, i) = fields%u(1, surfaces%node(i))
            surfaces%u(2, i) = fields%u(2, surfaces%node(i))
         end do
         model%contact%slices(slice)%moved = has_moved(model%contact%candidates, surfaces, first, &
            last)
      end associate
   end subroutine bring_positions

   !> Shape of the edges and predicted velocities of the nodes that contact may change.
   pure subroutine bring_velocities(model, slice)
      type(model_type), intent(inout) :: model
      integer, intent(in) :: slice

      integer :: i, k, first, last
      real(wp) :: speed

      associate (contact => model%contact, fields => model%fields)
         first = last_of(size(contact%near), slice - 1, contact%n_slices) + 1
         last = last_of(size(contact%near), slice, contact%n_slices)
         call update_edges(contact%surfaces, contact%near(first:last))
         speed = 0.0_wp
         do k = first, last
            i = contact%near(k)
            associate (at => contact%motion(i), node => contact%surfaces%node(i))
               at%v(1) = fields%v(1, node)
               at%v(2) = fields%v(2, node)
               speed = max(speed, at%v(1)**2 + at%v(2)**2)
            end associate
            contact%queue%newest(i) = 0
         end do
         contact%slices(slice)%speed = speed
         contact%slices(slice)%turned = has_turned(contact, contact%near(first:last))
      end associate
   end subroutine bring_velocities

   !> Corrected velocities and forces of the nodes, and what the correction adds to the sums.
   pure subroutine take_impulses(model, slice, sums)
      type(model_type), intent(inout) :: model
      integer, intent(in) :: slice
      real(wp), intent(out) :: sums(n_sums)

      integer :: k, node
      real(wp) :: per_step

      sums = 0.0_wp
      per_step = 1.0_wp/model%dt
      associate (contact => model%contact, fields => model%fields)
         do k = last_of(size(contact%near), slice - 1, most_slices) + 1, &
            last_of(size(contact%near), slice, most_slices)
            node = contact%surfaces%node(contact%near(k))
            associate (at => contact%record(contact%near(k)), v => contact%motion( &
                  contact%near(k))%v)
               fields%contact(1, node) = at%impulse(1)*per_step
               fields%contact(2, node) = at%impulse(2)*per_step
               if (.not. max(abs(at%impulse(1)), abs(at%impulse(2))) > 0.0_wp) cycle
               call correct_sums(model, node, at%before, v - fields%v(:, node), sums)
               fields%v(1, node) = v(1)
               fields%v(2, node) = v(2)
            end associate
         end do
      end associate
   end subroutine take_impulses

   !> What a change of velocity adds to kinetic energy and to the power of the damping.
   pure subroutine correct_sums(model, node, before, change, sums)
      type(model_type), intent(in) :: model
      integer, intent(in) :: node
      real(wp), intent(in) :: before(2)      !! velocity of the half step before [m/s]
      real(wp), intent(in) :: change(2)      !! of the velocity after [m/s]
      real(wp), intent(inout) :: sums(n_sums)

      real(wp) :: arm(2), drag(2), slip(2)

      associate (body => model%mesh%body_of_node(node), fields => model%fields)
         sums(1) = sums(1) &
            + 0.5_wp*fields%mass(node)*(before(1)*change(1) + before(2)*change(2))
         if (model%settings%damping == no_damping) return
         if (model%settings%damping == relative_to_affine) then
            associate (fit => model%affine(body))
               arm = model%mesh%nodes(:, node) + fields%u(:, node) - fit%centre
               slip = before - fit%velocity - fit%gradient(:, 1)*arm(1) - fit%gradient(:, 2)*arm(2)
            end associate
         else
            slip = 0.5_wp*(before + fields%v(:, node))
         end if
         drag = -model%alpha(body)*fields%drag_mass(:, node)*slip
         sums(3) = sums(3) + drag(1)*change(1) + drag(2)*change(2)
      end associate
   end subroutine correct_sums

   !> Work of the impulses of the step that ends, half of it on either side of its time.
   pure subroutine book_contact(model)
      type(model_type), intent(inout) :: model

      real(wp) :: work(2)

      associate (contact => model%contact)
         work = contact%work_after
         if (model%step > 0) work = work + contact%work_before
      end associate
      model%ledger%contact = model%ledger%contact + work(1)
      model%ledger%friction = model%ledger%friction + work(2)
   end subroutine book_contact

   subroutine explain(model, code, node, status)
      type(model_type), intent(in) :: model
      integer, intent(in) :: code
      integer, intent(in) :: node(2)
      type(status_type), intent(out) :: status

      character(len=240) :: words
      character(len=:), allocatable :: what

      select case (code)
      case (prescribed_collision)
         what = "contact: their prescribed motions collide; " &
            //"try a smaller end strain, or leave one of them free"
      case (too_fast)
         what = "contact: they pass each other too fast for the step; " &
            //"try a smaller time_step_factor or loading speed"
      case default
         what = "contact: a position is not finite; try a smaller time_step_factor or loading speed"
      end select
      write (words, "(a, i0, a, es11.4, a, i0, a, i0, 2a)") "step ", model%step, ", time ", &
         model%step*model%dt, " s, nodes ", node(1), " and ", node(2), ": ", what
      call set_failure(status, bad_contact, trim(words))
   end subroutine explain

end module lithofrac_run_contact_step
