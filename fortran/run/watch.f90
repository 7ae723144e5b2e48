!> What the guards of a run look at. A look changes nothing.
!>
!> Two things end a run in any case: a velocity that is not finite, and an element that has turned
!> inside out, whose answer would be smooth and wrong. All else are numbers with a place; whoever
!> asks holds them against thresholds.
module lithofrac_run_watch
   use lithofrac_base_kinds, only: wp
   use lithofrac_base_status, only: bad_element, not_finite, ok, set_failure, status_type
   use lithofrac_contact_intruders, only: find_intruder, intruder_type
   use lithofrac_fracture_arms, only: intra_element
   use lithofrac_mechanics_chunks, only: width
   use lithofrac_mechanics_fields, only: inelastic_type
   use lithofrac_mechanics_kinematics, only: area_ratios, gather
   use lithofrac_mesh_shape, only: critical_length
   use lithofrac_run_model, only: model_type
   implicit none
   private

   public :: check_state, look, sight_type

   !> Places are numbers of nodes and elements, 0 where there is none.
   type :: sight_type
      real(wp) :: area = 1.0_wp       !! smallest area of an element over that in the reference
      real(wp) :: speed = 0.0_wp      !! largest speed of a node over the P wave speed of its body
      real(wp) :: step = 1.0_wp       !! critical step of the smallest piece over that of the mesh
      real(wp) :: overlap = 0.0_wp    !! depth of a node in an element over the shortest edge
      integer :: area_element = 0
      integer :: speed_node = 0
      integer :: step_element = 0
      integer :: overlap_node = 0
      integer :: overlap_element = 0
      integer :: bad_node = 0         !! first one with a value that is not finite
      integer :: bad_element = 0      !! likewise
   end type sight_type

contains

   !> Fail if a velocity is not finite or an element has turned inside out.
   subroutine check_state(model, status)
      type(model_type), intent(in) :: model
      type(status_type), intent(out) :: status

      real(wp) :: area
      integer :: place

      if (.not. abs(sum(model%sums(1, :))) <= huge(1.0_wp)) then
         do place = 1, model%mesh%n_nodes - 1
            if (.not. all(abs(model%fields%v(:, place)) <= huge(1.0_wp))) exit
         end do
         call fail(model, not_finite, "node", place, "velocity is not finite; " &
            //"try a smaller time_step_factor or loading speed", status)
         return
      end if
      call find_smallest_area(model, area, place)
      if (area > 0.0_wp) return
      call fail(model, bad_element, "element", place, "it has turned inside out; " &
         //"try a smaller time_step_factor, loading speed or end strain, or a finer mesh", status)
   end subroutine check_state

   subroutine fail(model, code, what, place, words, status)
      type(model_type), intent(in) :: model
      integer, intent(in) :: code
      character(len=*), intent(in) :: what
      integer, intent(in) :: place
      character(len=*), intent(in) :: words
      type(status_type), intent(out) :: status

      character(len=200) :: sentence

      write (sentence, "(a, i0, a, es12.4e3, 3a, i0, 2a)") "step ", model%step, ", time ", &
         model%step*model%dt, " s, ", what, " ", place, ": ", words
      call set_failure(status, code, trim(sentence))
   end subroutine fail

   !> Look at everything.
   subroutine look(model, sight)
      type(model_type), intent(in) :: model
      type(sight_type), intent(out) :: sight

      call find_bad_values(model, sight%bad_node, sight%bad_element)
      if (sight%bad_node > 0 .or. sight%bad_element > 0) return
      call find_smallest_area(model, sight%area, sight%area_element)
      call find_fastest(model, sight%speed, sight%speed_node)
      call find_smallest_step(model, sight%step, sight%step_element)
      if (model%contact%on) call find_overlap(model, sight)
   end subroutine look

   !> First node and first element that something is wrong with. Forces and energies follow from
   !> displacement and inelastic strain; strengths and directions would hide what they lost.
   pure subroutine find_bad_values(model, node, element)
      type(model_type), intent(in) :: model
      integer, intent(out) :: node
      integer, intent(out) :: element

      integer :: chunk, lane

      element = 0
      do node = 1, model%mesh%n_nodes
         associate (u => model%fields%u(:, node), v => model%fields%v(:, node))
            if (.not. (all(abs(u) <= huge(1.0_wp)) .and. all(abs(v) <= huge(1.0_wp)))) return
         end associate
      end do
      node = 0
      do chunk = 1, model%chunks%n_chunks
         if (.not. model%state%touched(chunk)) cycle
         if (is_finite(model%state, 1, width, chunk)) cycle
         do lane = 1, model%chunks%filled(chunk)
            if (is_finite(model%state, lane, lane, chunk)) cycle
            element = model%chunks%element(lane, chunk)
            return
         end do
      end do
   end subroutine find_bad_values

   !> Is the state of some lanes of a chunk finite?
   pure function is_finite(state, first, last, chunk) result(yes)
      type(inelastic_type), intent(in) :: state
      integer, intent(in) :: first
      integer, intent(in) :: last
      integer, intent(in) :: chunk
      logical :: yes

      real(wp), parameter :: most = huge(1.0_wp)

      yes = all(abs(state%strain(first:last, :, chunk)) <= most) &
         .and. all(abs(state%plastic_strain(first:last, chunk)) <= most) &
         .and. all(abs(state%ft(first:last, :, chunk)) <= most) &
         .and. all(abs(state%opening(first:last, :, chunk)) <= most) &
         .and. all(abs(state%axis(first:last, :, chunk)) <= most) &
         .and. all(abs(state%crack(first:last, :, chunk)) <= most) &
         .and. all(abs(state%sin_phi(first:last, chunk)) <= most) &
         .and. all(abs(state%c_cos_phi(first:last, chunk)) <= most) &
         .and. all(abs(state%dissipated(first:last, :, chunk)) <= most)
   end function is_finite

   !> Smallest area of an element over that in the reference.
   subroutine find_smallest_area(model, area, element)
      type(model_type), intent(in) :: model
      real(wp), intent(out) :: area
      integer, intent(out) :: element

      real(wp) :: du(width, 4), ratio(width)
      integer :: chunk, lane

      area = huge(1.0_wp)
      element = 0
      do chunk = 1, model%chunks%n_chunks
         call gather(model%chunks%node(:, :, chunk), size(model%fields%u, 2), model%fields%u, du)
         call area_ratios(model%chunks%gradient(:, :, chunk), du, ratio)
         if (minval(ratio) >= area) cycle
         do lane = 1, model%chunks%filled(chunk)
            if (.not. ratio(lane) < area) cycle
            area = ratio(lane)
            element = model%chunks%element(lane, chunk)
         end do
      end do
   end subroutine find_smallest_area

   !> Largest speed of a node over the P wave speed of its body.
   subroutine find_fastest(model, speed, node)
      type(model_type), intent(in) :: model
      real(wp), intent(out) :: speed
      integer, intent(out) :: node

      real(wp) :: square, fastest, slowness(model%mesh%n_bodies)
      integer :: i

      slowness = 1.0_wp/p_wave_speed(model, [(i, i=1, model%mesh%n_bodies)])
      node = 0
      fastest = 0.0_wp
      do i = 1, model%mesh%n_nodes
         square = (model%fields%v(1, i)*slowness(model%mesh%body_of_node(i)))**2 &
            + (model%fields%v(2, i)*slowness(model%mesh%body_of_node(i)))**2
         if (.not. square > fastest) cycle
         fastest = square
         node = i
      end do
      speed = sqrt(fastest)
   end subroutine find_fastest

   elemental function p_wave_speed(model, body) result(speed)
      type(model_type), intent(in) :: model
      integer, intent(in) :: body
      real(wp) :: speed   !! [m/s]

      associate (rock => model%rocks(body))
         speed = sqrt((rock%lame + 2.0_wp*rock%shear)/rock%density)
      end associate
   end function p_wave_speed

   !> Critical step of the smallest piece of a cut element, over that of the mesh at the start.
   !>
   !> Steps follow the reference geometry, so only cuts change them, and those are in plane strain.
   subroutine find_smallest_step(model, step, element)
      type(model_type), intent(in) :: model
      real(wp), intent(out) :: step
      integer, intent(out) :: element

      real(wp) :: at_start, ratio
      integer :: i

      step = 1.0_wp
      element = 0
      if (.not. model%fracture%on) return
      associate (rules => model%fracture%rules, topology => model%fracture%topology, &
            mesh => model%mesh)
         if (rules%mode /= intra_element) return
         at_start = model%critical/rules%guard%least_step
         do i = 1, mesh%n_elements
            if (.not. topology%alive(i) .or. topology%origin(i) == i) cycle
            ratio = critical_length(mesh%nodes(:, mesh%triangles(:, i)), &
               model%rocks(mesh%body(i))%poisson)/p_wave_speed(model, mesh%body(i))/at_start
            if (.not. ratio < step) cycle
            step = ratio
            element = i
         end do
      end associate
   end subroutine find_smallest_step

   !> Deepest boundary node inside an element of which it is no corner.
   subroutine find_overlap(model, sight)
      type(model_type), intent(in) :: model
      type(sight_type), intent(inout) :: sight

      type(intruder_type) :: found
      logical :: alive(model%mesh%n_elements)

      alive = .true.
      associate (n => model%mesh%n_nodes, m => model%mesh%n_elements)
         if (model%fracture%on) alive = model%fracture%topology%alive(:m)
         call find_intruder(model%contact%surfaces%node, model%mesh%nodes(:, :n) &
            + model%fields%u, model%mesh%triangles(:, :m), alive, found)
      end associate
      sight%overlap = found%depth/model%contact%surfaces%h
      sight%overlap_node = found%node
      sight%overlap_element = found%element
   end subroutine find_overlap

end module lithofrac_run_watch
