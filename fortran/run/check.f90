!> What must hold of a model that cracks, in words: for tests.
module lithofrac_run_check
   use lithofrac_base_status, only: bad_input, ok, set_failure, status_type
   use lithofrac_mesh_check, only: check_topology
   use lithofrac_run_model, only: model_type
   implicit none
   private

   public :: check_model

contains

   !> Say which invariant is broken first.
   !>
   !> The topology is sound; every living element has one lane with its corners, and whoever asks
   !> for one that was cut finds a living piece of it; nodal fields have one column a node.
   subroutine check_model(model, status)
      type(model_type), intent(in) :: model
      type(status_type), intent(out) :: status

      integer :: element

      if (.not. model%fracture%on) return
      call check_topology(model%mesh, model%fracture%topology, status)
      if (status%code /= ok) return
      associate (n => model%mesh%n_nodes, fields => model%fields)
         if (any([size(fields%u, 2), size(fields%v, 2), size(fields%internal, 2), &
            size(fields%external, 2), size(fields%contact, 2), size(fields%mass), &
            size(fields%free_mass, 2), size(fields%inverse_mass, 2), &
            size(model%fracture%retry)] /= n)) then
            call set_failure(status, bad_input, "run: a field does not have one value a node")
         end if
      end associate
      associate (alive => model%fracture%topology%alive(:model%mesh%n_elements))
         if (sum(model%chunks%filled) /= count(alive)) then
            call set_failure(status, bad_input, "run: a living element has no lane, or two")
         end if
      end associate
      do element = 1, model%mesh%n_elements
         if (status%code == ok) call check_element(model, element, status)
      end do
   end subroutine check_model

   subroutine check_element(model, element, status)
      type(model_type), intent(in) :: model
      integer, intent(in) :: element
      type(status_type), intent(inout) :: status

      character(len=80) :: words

      associate (heir => model%fracture%heir(element), chunks => model%chunks, mesh => model%mesh, &
            topology => model%fracture%topology)
         write (words, "(a, i0, a)") "run: element ", element, " has a wrong heir or wrong corners"
         if (.not. topology%alive(heir) .or. topology%origin(heir) /= topology%origin(element) &
            .or. (topology%alive(element) .neqv. heir == element)) then
            call set_failure(status, bad_input, trim(words))
         else if (chunks%element(chunks%lane_of(element), chunks%chunk_of(element)) /= heir &
            .or. any(chunks%node(chunks%lane_of(element), :, chunks%chunk_of(element)) &
               /= mesh%triangles(:, heir))) then
            call set_failure(status, bad_input, trim(words))
         end if
      end associate
   end subroutine check_element

end module lithofrac_run_check
