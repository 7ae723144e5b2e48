!> Let every owner of nodes and elements follow the mesh after cracks.
!>
!> Between two steps: displacement, internal and contact forces are of time n, velocities of the
!> half step after it. Momentum and the work of every force stay as they are; only mass that goes
!> to a new node on a cut edge may take kinetic energy, which is booked.
module lithofrac_run_grow
   use lithofrac_base_kinds, only: wp
   use lithofrac_base_status, only: ok, status_type
   use lithofrac_contact_rebuild, only: rebuild_contact
   use lithofrac_contact_surfaces, only: tag_edges
   use lithofrac_fracture_fragment_drag, only: drag_power, list_loose_nodes
   use lithofrac_fracture_fragments, only: find_parts
   use lithofrac_mechanics_blocks, only: new_blocks
   use lithofrac_mechanics_chunks, only: chunks_type, new_chunks, set_corners
   use lithofrac_mechanics_fields, only: inelastic_type, move_inelastic, new_inelastic, prescribe
   use lithofrac_mechanics_follow_loads, only: follow_pressure, follow_velocity
   use lithofrac_mechanics_internal_force, only: element_force
   use lithofrac_mechanics_loads, only: add_forces, prescribed_kinetic, work_after, work_before
   use lithofrac_mesh_edge_set, only: edge_nodes, follow_edges
   use lithofrac_mesh_edits, only: edits_type, inherit
   use lithofrac_mesh_mesh, only: living_part
   use lithofrac_mesh_rings, only: fan_of_node, fan_type
   use lithofrac_run_contact_step, only: bring_masses
   use lithofrac_run_damping, only: n_moments
   use lithofrac_run_model, only: model_type, set_mass
   use lithofrac_run_node_update, only: n_sums
   use lithofrac_run_settings, only: relative_to_affine
   implicit none
   private

   public :: grow, new_layout, rebuild

contains

   !> Follow `edits` of the mesh.
   subroutine grow(model, edits, status)
      type(model_type), intent(inout) :: model
      type(edits_type), intent(in) :: edits
      type(status_type), intent(out) :: status

      integer :: i
      real(wp) :: energy(4)

      energy = energies(model)
      call grow_elements(model, edits)
      call inherit(edits, model%fields%u)
      call inherit(edits, model%fields%v)
      do i = 1, size(model%velocities)
         call follow_velocity(model%velocities(i), edits)
      end do
      do i = 1, size(model%pressures)
         call follow_pressure(model%pressures(i), model%mesh, model%fracture%topology, edits)
      end do
      call follow_tags(model, edits)
      model%reference_step = -1
      call rebuild(model, status)
      if (status%code /= ok) return
      call renew_forces(model, edits)
      energy = energies(model) - energy
      if (edits%n_elements == 0) energy(1) = 0.0_wp
      call book_change(model, energy)
   end subroutine grow

   !> Mass and forces have gone to new nodes on edges that were cut, and drag has ended.
   !>
   !> A new node between a driven and a free one is free, so reactions change; but both half
   !> steps around now have had the old ones.
   subroutine book_change(model, change)
      type(model_type), intent(inout) :: model
      real(wp), intent(in) :: change(4)         !! of `energies`

      associate (ledger => model%ledger, kinetic => model%sums(1, size(model%sums, 2)))
         ledger%relump = ledger%relump + change(1)
         ledger%external = ledger%external - change(3) - change(4)
         kinetic = kinetic + change(1) - change(2) - change(4)
      end associate
   end subroutine book_change

   !> All that follows from mesh, topology, heirs and loads; nodal fields get their new length.
   subroutine rebuild(model, status)
      type(model_type), intent(inout) :: model
      type(status_type), intent(out) :: status

      integer :: i, n

      n = model%mesh%n_nodes
      associate (fields => model%fields)
         fields%u = fields%u(:, :n)
         fields%v = fields%v(:, :n)
         call extend(fields%internal, n)
         call extend(fields%external, n)
         call extend(fields%contact, n)
      end associate
      call set_mass(model)
      do i = 1, size(model%velocities)
         associate (load => model%velocities(i))
            call prescribe(model%fields, load%component, load%node)
         end associate
      end do
      if (model%settings%damping == relative_to_affine) call loosen_fragments(model)
      call new_blocks(model%blocks, model%chunks, model%mesh)
      call resize_sums(model)
      call rebuild_contact(model%contact, living_part(model%mesh, &
         model%fracture%topology%alive), model%fields%u, status)
      if (status%code /= ok) return
      do i = 1, size(model%tags)
         call tag_edges(model%contact%surfaces, edge_nodes(model%mesh, &
            model%tagged(:, i:i)), model%tags(i), status)
         if (status%code /= ok) return
      end do
      call bring_masses(model)
   end subroutine rebuild

   !> Loose fragments take no part in the damping of their body; they have their own.
   subroutine loosen_fragments(model)
      type(model_type), intent(inout) :: model

      real(wp) :: lost   !! power that is still to be booked of who is not loose any more [W]

      associate (drag => model%fracture%drag, fields => model%fields)
         lost = drag_power(drag, fields%v)
         call list_loose_nodes(drag, model%mesh, &
            find_parts(model%mesh, model%fracture%topology))
         lost = lost - drag_power(drag, fields%v)
         model%ledger%damping = model%ledger%damping + 0.5_wp*model%dt*lost
         associate (kinetic => model%sums(1, size(model%sums, 2)))
            kinetic = kinetic + 0.5_wp*model%dt*lost
         end associate
         fields%drag_mass(:, drag%node) = 0.0_wp
         fields%fit_mass(drag%node) = 0.0_wp
      end associate
   end subroutine loosen_fragments

   !> Corners of elements that were given copies, and the layout anew where elements were cut.
   subroutine grow_elements(model, edits)
      type(model_type), intent(inout) :: model
      type(edits_type), intent(in) :: edits

      type(chunks_type) :: old_chunks
      type(inelastic_type) :: old_state
      integer, allocatable :: source(:)
      integer :: i

      if (edits%n_elements == 0) then
         do i = 1, edits%n_changed
            call set_corners(model%chunks, model%mesh, edits%changed(i))
         end do
         return
      end if
      call inherit_elements(model, edits, source)
      old_chunks = model%chunks
      old_state = model%state
      call new_layout(model)
      call move_inelastic(old_state, old_chunks, source, model%chunks, model%state)
   end subroutine grow_elements

   !> Chunks of the living elements, with a state that is still to be filled in. Whoever asks for
   !> an element that was cut finds a piece of it.
   subroutine new_layout(model)
      type(model_type), intent(inout) :: model

      associate (chunks => model%chunks, heir => model%fracture%heir)
         call new_chunks(chunks, model%mesh, .false., model%fracture%topology%alive)
         call new_inelastic(model%state, chunks, model%rocks, &
            spread(0.0_wp, 1, model%mesh%n_elements))
         chunks%lane_of = chunks%lane_of(heir)
         chunks%chunk_of = chunks%chunk_of(heir)
      end associate
   end subroutine new_layout

   !> Counts of resets, heirs, and for every element the one of the old layout that it comes from.
   subroutine inherit_elements(model, edits, source)
      type(model_type), intent(inout) :: model
      type(edits_type), intent(in) :: edits
      integer, allocatable, intent(out) :: source(:)  !! (n_elements)

      integer :: element, parent, i

      source = [(i, i=1, model%mesh%n_elements)]
      associate (fracture => model%fracture, before => edits%elements_before)
         fracture%heir = [fracture%heir, source(before + 1:)]
         fracture%resets = [fracture%resets, spread(0, 1, edits%n_elements)]
         do i = 1, edits%n_elements
            parent = edits%element_parent(i)
            source(before + i) = source(parent)
            fracture%resets(before + i) = fracture%resets(parent)
         end do
         do i = edits%n_elements, 1, -1
            fracture%heir(edits%element_parent(i)) = before + i
         end do
         do element = 1, model%mesh%n_elements
            do while (.not. fracture%topology%alive(fracture%heir(element)))
               fracture%heir(element) = fracture%heir(fracture%heir(element))
            end do
         end do
      end associate
   end subroutine inherit_elements

   subroutine follow_tags(model, edits)
      type(model_type), intent(inout) :: model
      type(edits_type), intent(in) :: edits

      integer, allocatable :: source(:)

      call follow_edges(model%mesh, model%fracture%topology, &
         edits%element_parent(:edits%n_elements), edits%elements_before + 1, model%tagged, source)
      model%tags = model%tags(source)
   end subroutine follow_tags

   !> Forces of time n on nodes that were born or split, so that every sum stays as it was.
   subroutine renew_forces(model, edits)
      type(model_type), intent(inout) :: model
      type(edits_type), intent(in) :: edits

      integer :: i, k, node

      associate (fields => model%fields)
         do i = 1, edits%n_nodes
            node = edits%nodes_before + i
            fields%internal(:, node) = internal_at(model, node)
            do k = 1, 2
               node = edits%node_parent(k, i)
               fields%internal(:, node) = internal_at(model, node)
            end do
         end do
         do i = 1, edits%n_elements
            do k = 1, 3
               node = model%mesh%triangles(k, edits%elements_before + i)
               fields%internal(:, node) = internal_at(model, node)
            end do
         end do
         fields%external = 0.0_wp
         do i = 1, size(model%pressures)
            call add_forces(model%pressures(i), fields)
         end do
         do i = 1, size(model%fracture%bonds%list)
            associate (bond => model%fracture%bonds%list(i))
               fields%external(:, bond%node) = fields%external(:, bond%node) + bond%force
            end associate
         end do
         associate (drag => model%fracture%drag)
            fields%external(:, drag%node) = fields%external(:, drag%node) + drag%force
         end associate
      end associate
   end subroutine renew_forces

   !> Internal force of a node as it is, summed over its elements [N].
   function internal_at(model, node) result(force)
      type(model_type), intent(in) :: model
      integer, intent(in) :: node
      real(wp) :: force(2)

      type(fan_type) :: fan
      real(wp) :: corners(2, 3)
      integer :: i

      force = 0.0_wp
      call fan_of_node(model%mesh, model%fracture%topology, node, fan)
      do i = 1, fan%n
         associate (element => fan%element(i))
            corners = element_force(model%chunks, element, model%rocks(model%mesh%body(element)), &
               model%fields, model%state)
         end associate
         force = force + corners(:, fan%corner(i))
      end do
   end function internal_at

   !> Longer columns for new runs; what the step has summed so far stays, contact last.
   subroutine resize_sums(model)
      type(model_type), intent(inout) :: model

      real(wp), allocatable :: sums(:, :)
      integer :: n

      n = size(model%sums, 2)
      deallocate (model%moments)
      allocate (model%moments(n_moments, model%blocks%n_runs), source=0.0_wp)
      allocate (sums(n_sums, model%blocks%n_runs + 1), source=0.0_wp)
      sums(:, :n - 1) = model%sums(:, :n - 1)
      sums(:, size(sums, 2)) = model%sums(:, n)
      call move_alloc(sums, model%sums)
   end subroutine resize_sums

   !> Kinetic energy at the half step, what the sums lack of the present one, and work of the
   !> loads in the half steps before and after now [J].
   pure function energies(model)
      type(model_type), intent(in) :: model
      real(wp) :: energies(4)

      associate (velocities => model%velocities, pressures => model%pressures, &
            fields => model%fields)
         energies = [half_step_energy(model), prescribed_kinetic(velocities, fields), &
            work_before(velocities, pressures, model%dt, fields), &
            work_after(velocities, pressures, model%dt, fields)]
      end associate
   end function energies

   !> Kinetic energy at the half step [J].
   pure function half_step_energy(model) result(energy)
      type(model_type), intent(in) :: model
      real(wp) :: energy

      integer :: node

      energy = 0.0_wp
      do node = 1, size(model%fields%mass)
         energy = energy + 0.5_wp*model%fields%mass(node)*sum(model%fields%v(:, node)**2)
      end do
   end function half_step_energy

   !> Room for `n` nodes; new ones have nothing.
   pure subroutine extend(values, n)
      real(wp), allocatable, intent(inout) :: values(:, :)
      integer, intent(in) :: n

      real(wp), allocatable :: longer(:, :)

      if (size(values, 2) == n) return
      allocate (longer(size(values, 1), n), source=0.0_wp)
      longer(:, :size(values, 2)) = values
      call move_alloc(longer, values)
   end subroutine extend

end module lithofrac_run_grow
