!> Insert the cracks that are due, between two steps (Klerck, Sellers & Owen 2004, section 2.5):
!> failure map, order, topological update, state of the failed elements, release of what is left.
!>
!> A crack is a transaction: a way that a guard forbids is taken back and replaced by one along
!> edges, or put off until the node has failed further.
module lithofrac_run_insert_cracks
   use lithofrac_base_kinds, only: wp
   use lithofrac_base_status, only: ok, status_type
   use lithofrac_fracture_arms, only: choose_arms, inter_element
   use lithofrac_fracture_bonds, only: add_bond, bond_type
   use lithofrac_fracture_element_failure, only: any_failed, paper_reset, reset_element, &
      set_failure_factors
   use lithofrac_fracture_fracture, only: record_crack
   use lithofrac_fracture_plan, only: crack_type, plan_cracks, worth_another_look
   use lithofrac_mesh_cut, only: sound
   use lithofrac_mesh_edits, only: edits_type, merge_edits, start_edits
   use lithofrac_mesh_rings, only: fan_of_node, fan_type
   use lithofrac_mesh_split, only: arm_type, open_arms
   use lithofrac_mesh_topology, only: next_corner
   use lithofrac_run_grow, only: grow
   use lithofrac_run_model, only: model_type
   implicit none
   private

   public :: insert_cracks

   integer, parameter :: least_release = 20           !! steps
   real(wp), parameter :: release_passages = 2.0_wp   !! of a shear wave along the crack

contains

   !> Look for failed nodes and let them crack.
   subroutine insert_cracks(model, status)
      type(model_type), intent(inout) :: model
      type(status_type), intent(out) :: status

      type(crack_type), allocatable :: cracks(:)
      type(edits_type) :: edits
      real(wp), allocatable :: factor(:), normal(:, :)
      integer, allocatable :: release(:)
      integer :: i, n_closed

      associate (fracture => model%fracture)
         if (.not. is_due(model)) return
         allocate (factor(model%mesh%n_elements), normal(2, model%mesh%n_elements))
         call set_failure_factors(model%chunks, model%rocks, model%state, factor, normal)
         call plan_cracks(model%mesh, fracture%topology, factor, normal, fracture%rules, &
            fracture%retry, cracks, fracture%n_waiting, n_closed)
         call renew_grains(model, factor)
         if (size(cracks) == 0) return
         call start_edits(edits, model%mesh)
         allocate (release(0))
         do i = 1, size(cracks)
            call open_crack(model, cracks(i), factor, edits, release)
         end do
         fracture%retry = [fracture%retry, spread(0.0_wp, 1, edits%n_nodes)]
      end associate
      call grow(model, edits, status)
      if (status%code == ok) call hold_together(model, edits, release)
   end subroutine insert_cracks

   !> Is there anything that the last failure map has not seen?
   function is_due(model) result(yes)
      type(model_type), intent(inout) :: model
      logical :: yes

      real(wp) :: failed

      yes = .false.
      associate (fracture => model%fracture)
         if (mod(model%step, fracture%interval) /= 0) return
         failed = any_failed(model%chunks, model%rocks, model%state)
         yes = failed > 0.0_wp &
            .and. (abs(failed - fracture%looked_at) > 0.0_wp .or. fracture%n_waiting > 0)
         fracture%looked_at = failed
      end associate
   end function is_due

   !> Open one crack, reset the elements that failed there, and put it on record.
   subroutine open_crack(model, crack, factor, edits, release)
      type(model_type), intent(inout) :: model
      type(crack_type), intent(in) :: crack
      real(wp), intent(in) :: factor(:)                 !! F_k before
      type(edits_type), intent(inout) :: edits          !! this crack's are added
      integer, allocatable, intent(inout) :: release(:) !! steps for each new node; added to

      type(edits_type) :: own
      type(arm_type), allocatable :: arms(:)
      type(fan_type) :: fan
      real(wp), allocatable :: ends(:, :)
      integer, allocatable :: far(:)
      integer :: verdict, n_steps
      logical :: is_fallback

      associate (fracture => model%fracture, mesh => model%mesh)
         allocate (arms, source=crack%arms)
         call fan_of_node(mesh, fracture%topology, crack%node, fan)
         call find_ends(model, crack%node, arms, ends, far)
         call open_arms(mesh, fracture%topology, arms, fracture%rules%guard, own, verdict)
         is_fallback = verdict /= sound
         if (is_fallback) then
            call choose_arms(mesh, fracture%topology, fan, crack%failure%along, inter_element, &
               fracture%rules%guard, arms)
            if (size(arms) == 0) then
               fracture%retry(crack%node) = worth_another_look*crack%failure%factor
               return
            end if
            fracture%n_fallbacks = fracture%n_fallbacks + 1
            call find_ends(model, crack%node, arms, ends, far)
            call open_arms(mesh, fracture%topology, arms, fracture%rules%guard, own, verdict)
         end if
         fracture%n_cracks = fracture%n_cracks + 1
         n_steps = fracture%release_steps
         if (n_steps < 0) n_steps = steps_along(model, crack%node, ends)
         call record(model, crack, arms, ends, far, own, fan, is_fallback, n_steps)
         call reset_failed(model, crack, fan, factor)
         call merge_edits(edits, own)
         release = [release, spread(n_steps, 1, own%n_nodes)]
      end associate
   end subroutine open_crack

   !> Reference positions of the node and of the far ends of its arms, and the nodes there
   !> (0: a new one).
   subroutine find_ends(model, node, arms, ends, far)
      type(model_type), intent(in) :: model
      integer, intent(in) :: node
      type(arm_type), intent(in) :: arms(:)
      real(wp), allocatable, intent(out) :: ends(:, :)   !! (2, 1 + arms) [m]
      integer, allocatable, intent(out) :: far(:)        !! (arms)

      integer :: i, first, second

      allocate (ends(2, 1 + size(arms)), far(size(arms)))
      ends(:, 1) = model%mesh%nodes(:, node)
      do i = 1, size(arms)
         first = model%mesh%triangles(arms(i)%edge, arms(i)%element)
         second = model%mesh%triangles(next_corner(arms(i)%edge), arms(i)%element)
         associate (nodes => model%mesh%nodes)
            if (arms(i)%through) then
               far(i) = 0
               ends(:, 1 + i) = nodes(:, first) + arms(i)%s*(nodes(:, second) - nodes(:, first))
            else
               far(i) = merge(second, first, first == node)
               ends(:, 1 + i) = nodes(:, far(i))
            end if
         end associate
      end do
   end subroutine find_ends

   !> Steps that a shear wave takes to run along the new crack and back.
   function steps_along(model, node, ends) result(n_steps)
      type(model_type), intent(in) :: model
      integer, intent(in) :: node
      real(wp), intent(in) :: ends(:, :)
      integer :: n_steps

      real(wp) :: length, speed
      integer :: i

      length = 0.0_wp
      do i = 2, size(ends, 2)
         length = length + norm2(ends(:, i) - ends(:, 1))
      end do
      associate (rock => model%rocks(model%mesh%body_of_node(node)))
         speed = sqrt(rock%shear/rock%density)
      end associate
      n_steps = max(least_release, ceiling(release_passages*length/(speed*model%dt)))
   end function steps_along

   subroutine record(model, crack, arms, ends, far, edits, fan, is_fallback, n_steps)
      type(model_type), intent(inout) :: model
      type(crack_type), intent(in) :: crack
      type(arm_type), intent(in) :: arms(:)
      real(wp), intent(in) :: ends(:, :)
      integer, intent(in) :: far(:)
      type(edits_type), intent(in) :: edits   !! of this crack alone
      type(fan_type), intent(in) :: fan       !! of the node, before
      logical, intent(in) :: is_fallback
      integer, intent(in) :: n_steps

      real(wp) :: direction, share
      integer :: i

      direction = atan2(crack%failure%along(2), crack%failure%along(1))
      share = compressive_share(model, fan)
      do i = 1, size(arms)
         call record_crack(model%fracture, [real(model%step, wp), &
            real(model%fracture%n_cracks, wp), ends(:, 1), ends(:, 1 + i), &
            norm2(ends(:, 1 + i) - ends(:, 1)), direction, crack%failure%factor, &
            crack%failure%agreement, share, flag(is_split(edits, far(i), ends(:, 1 + i), model)), &
            flag(arms(i)%through), flag(is_fallback), real(n_steps, wp), &
            real(model%mesh%body_of_node(crack%node), wp)])
      end do
   end subroutine record

   pure function flag(yes) result(value)
      logical, intent(in) :: yes
      real(wp) :: value

      value = merge(1.0_wp, 0.0_wp, yes)
   end function flag

   !> Has a node at the far end been given a copy?
   function is_split(edits, far, position, model) result(yes)
      type(edits_type), intent(in) :: edits
      integer, intent(in) :: far               !! node, 0: a new one
      real(wp), intent(in) :: position(2)      !! of a new one [m]
      type(model_type), intent(in) :: model
      logical :: yes

      integer :: i, parent

      yes = .true.
      do i = 1, edits%n_nodes
         parent = edits%node_parent(1, i)
         if (parent /= edits%node_parent(2, i)) cycle
         if (parent == far) return
         if (far == 0 .and. all(abs(model%mesh%nodes(:, parent) - position) <= 0.0_wp)) return
      end do
      yes = .false.
   end function is_split

   !> Part of what the elements at a node have dissipated that the Mohr-Coulomb planes took.
   function compressive_share(model, fan) result(share)
      type(model_type), intent(in) :: model
      type(fan_type), intent(in) :: fan
      real(wp) :: share

      real(wp) :: work(2)
      integer :: i

      work = 0.0_wp
      do i = 1, fan%n
         associate (chunk => model%chunks%chunk_of(fan%element(i)), &
               lane => model%chunks%lane_of(fan%element(i)))
            work = work + model%chunks%volume(lane, chunk)*model%state%dissipated(lane, :, chunk)
         end associate
      end do
      share = 0.0_wp
      if (sum(work) > 0.0_wp) share = work(1)/sum(work)
   end function compressive_share

   !> Elements at the node that have used up their fracture energy.
   subroutine reset_failed(model, crack, fan, factor)
      type(model_type), intent(inout) :: model
      type(crack_type), intent(in) :: crack
      type(fan_type), intent(in) :: fan
      real(wp), intent(in) :: factor(:)

      real(wp) :: regained
      integer :: i

      do i = 1, fan%n
         associate (element => fan%element(i))
            if (factor(element) < 1.0_wp) cycle
            call reset_element(model%chunks, element, model%rocks(model%mesh%body(element)), &
               crack%failure%along, model%fracture%reset, model%state, regained)
            model%fracture%resets(element) = model%fracture%resets(element) + 1
            model%ledger%reset = model%ledger%reset + regained
         end associate
      end do
   end subroutine reset_failed

   !> Bonds that keep the accelerations of split nodes equal for now; their contact forces are
   !> shared by mass.
   subroutine hold_together(model, edits, release)
      type(model_type), intent(inout) :: model
      type(edits_type), intent(in) :: edits
      integer, intent(in) :: release(:)            !! steps for each new node

      integer, allocatable :: root(:), group(:)
      integer :: i, k

      allocate (root(edits%n_nodes))
      do i = 1, edits%n_nodes
         associate (parent => edits%node_parent(:, i))
            root(i) = parent(1)
            if (parent(1) /= parent(2)) then
               root(i) = 0
            else if (parent(1) > edits%nodes_before) then
               associate (first => root(parent(1) - edits%nodes_before))
                  if (first > 0) root(i) = first
               end associate
            end if
         end associate
      end do
      do i = 1, edits%n_nodes
         if (root(i) == 0 .or. any(root(:i - 1) == root(i))) cycle
         group = [root(i), pack([(edits%nodes_before + k, k=1, edits%n_nodes)], root == root(i))]
         call tie(model, group, maxval(release, mask=root == root(i)))
      end do
   end subroutine hold_together

   !> An element on its own has no edge left to open: with its strength used up it would flow
   !> without end, and turn inside out. When it has failed twice over it begins anew, whatever
   !> the rule of reset: its damage is that of the cracks around it.
   subroutine renew_grains(model, factor)
      type(model_type), intent(inout) :: model
      real(wp), intent(in) :: factor(:)            !! (n_elements) failure factors

      real(wp), parameter :: any_way(2) = [1.0_wp, 0.0_wp]
      real(wp), parameter :: twice = 2.0_wp  ! 1 would renew what failed as it came loose
      real(wp) :: regained
      integer :: element

      associate (topology => model%fracture%topology)
         do element = 1, model%mesh%n_elements
            if (factor(element) < twice .or. .not. topology%alive(element)) cycle
            if (any(topology%neighbour(:, element) > 0)) cycle
            call reset_element(model%chunks, element, model%rocks(model%mesh%body(element)), &
               any_way, paper_reset, model%state, regained)
            model%ledger%reset = model%ledger%reset + regained
         end do
      end associate
   end subroutine renew_grains

   subroutine tie(model, group, n_steps)
      type(model_type), intent(inout) :: model
      integer, intent(in) :: group(:)              !! copies of one node, the first has its forces
      integer, intent(in) :: n_steps

      real(wp) :: share(size(group)), pull(2, size(group)), contact(2)
      integer :: i

      associate (fields => model%fields)
         share = fields%mass(group)/sum(fields%mass(group))
         contact = fields%contact(:, group(1))
         pull = fields%internal(:, group) - fields%external(:, group)
         pull = pull - spread(sum(pull, dim=2), 2, size(group))*spread(share, 1, 2)
         where (.not. fields%inverse_mass(:, group) > 0.0_wp) pull = 0.0_wp
         do i = 1, size(group)
            fields%contact(:, group(i)) = share(i)*contact
            if (n_steps == 0) cycle
            call add_bond(model%fracture%bonds, &
               bond_type(group(i), model%step, n_steps, pull(:, i)))
         end do
      end associate
   end subroutine tie

end module lithofrac_run_insert_cracks
