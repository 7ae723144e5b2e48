!> Contact within a step of the run: motion in, corrected velocities and sums out.
!>
!> The node update has predicted velocities without contact. The correction also reaches what
!> the update has summed on its way: kinetic energy, power of the damping, moments.
module lithofrac_run_contact_step
   use lithofrac_base_kinds, only: wp
   use lithofrac_base_status, only: bad_contact, set_failure, status_type
   use lithofrac_contact_contact, only: prescribed_collision, solve_contact, solved, too_fast
   use lithofrac_run_model, only: model_type
   use lithofrac_run_settings, only: no_damping, relative_to_affine
   implicit none
   private

   public :: bring_masses, book_contact, close_contacts, note_velocities

contains

   !> Masses of the boundary nodes, once no load will change any more.
   subroutine bring_masses(model)
      type(model_type), intent(inout) :: model

      associate (contact => model%contact)
         contact%inverse_mass = model%fields%inverse_mass(:, contact%surfaces%node)
      end associate
   end subroutine bring_masses

   !> Keep the velocities of the half step that ends.
   pure subroutine note_velocities(model)
      type(model_type), intent(inout) :: model

      integer :: i

      associate (contact => model%contact)
         do i = 1, contact%surfaces%n
            contact%before(:, i) = model%fields%v(:, contact%surfaces%node(i))
         end do
      end associate
   end subroutine note_velocities

   !> Add the contact impulses of this step to the predicted velocities.
   subroutine close_contacts(model, status)
      type(model_type), intent(inout) :: model
      type(status_type), intent(out) :: status

      integer :: i, code, pair(2)

      associate (contact => model%contact, fields => model%fields)
         do i = 1, contact%surfaces%n
            associate (node => contact%surfaces%node(i))
               contact%surfaces%u(:, i) = fields%u(:, node)
               contact%v(:, i) = fields%v(:, node)
            end associate
         end do
         call solve_contact(contact, model%dt, model%critical, code, pair)
         if (code /= solved) then
            call explain(model, code, contact%surfaces%node(pair), status)
            return
         end if
         model%sums(:, model%blocks%n_runs + 1) = 0.0_wp
         do i = 1, contact%surfaces%n
            associate (node => contact%surfaces%node(i))
               if (any(abs(contact%impulse(:, i)) > 0.0_wp)) call correct(model, i, node)
               fields%contact(:, node) = contact%impulse(:, i)/model%dt
            end associate
         end do
      end associate
   end subroutine close_contacts

   !> Velocity of one node, and the sums that it is part of.
   subroutine correct(model, i, node)
      type(model_type), intent(inout) :: model
      integer, intent(in) :: i       !! boundary node
      integer, intent(in) :: node    !! its number in the mesh

      real(wp) :: change(2), drag(2), arm(2)
      integer :: body

      body = model%mesh%body_of_node(node)
      associate (fields => model%fields, before => model%contact%before(:, i), &
            sums => model%sums(:, model%blocks%n_runs + 1))
         change = model%contact%v(:, i) - fields%v(:, node)
         select case (model%settings%damping)
         case (no_damping)
            drag = 0.0_wp
         case (relative_to_affine)
            arm = model%mesh%nodes(:, node) + fields%u(:, node) - model%affine(body)%centre
            drag = -model%alpha(body)*fields%free_mass(:, node)*(before &
               - model%affine(body)%velocity - matmul(model%affine(body)%gradient, arm))
         case default
            drag = -0.5_wp*model%alpha(body)*fields%free_mass(:, node) &
               *(before + fields%v(:, node))
         end select
         sums(1) = sums(1) + 0.5_wp*fields%mass(node)*dot_product(before, change)
         sums(3) = sums(3) + dot_product(drag, change)
         fields%v(:, node) = model%contact%v(:, i)
      end associate
   end subroutine correct

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
         what = "contact: their prescribed motions collide"
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
