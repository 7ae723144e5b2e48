!> Which nodes crack, in what order, and how (Klerck, Sellers & Owen 2004, section 2.5,
!> steps 1 and 2).
!>
!> Decides only: the mesh stays as it is. The most failed node goes first and locks the elements
!> that its crack touches; what would touch them too waits for the next step, when states have
!> changed.
module lithofrac_fracture_plan
   use lithofrac_base_kinds, only: wp
   use lithofrac_fracture_arms, only: choose_arms, inter_element
   use lithofrac_fracture_failure_map, only: average_at_node, by_volume, mean_factor, &
      nodal_failure_type
   use lithofrac_mesh_cut, only: guard_type
   use lithofrac_mesh_mesh, only: mesh_type
   use lithofrac_mesh_rings, only: fan_of_node, fan_type
   use lithofrac_mesh_split, only: arm_type
   use lithofrac_mesh_topology, only: topology_type
   implicit none
   private

   public :: crack_type, plan_cracks, rules_type, worth_another_look

   !> A node without a way for a crack is looked at again when F_p has grown by this factor.
   real(wp), parameter :: worth_another_look = 1.05_wp

   !> How cracks are planned.
   type :: rules_type
      integer :: mode = inter_element   !! as in `fracture/arms`
      integer :: weights = by_volume    !! as in `fracture/failure_map`
      integer :: most_cracks = 50       !! planned at a time
      type(guard_type) :: guard         !! of elements that are cut
      real(wp) :: least_factor = 1.0_wp !! F_p from which a node cracks, not below 1
   end type rules_type

   !> One crack to insert.
   type :: crack_type
      integer :: node = 0
      type(nodal_failure_type) :: failure
      type(arm_type), allocatable :: arms(:)
   end type crack_type

contains

   !> Plan cracks at nodes with F_p >= 1, or what the rules say, in the order (-F_p, node).
   !>
   !> A mean reaches 1 only where an element does, so other nodes are not looked at.
   pure subroutine plan_cracks(mesh, topology, factor, normal, rules, retry, cracks, n_waiting, &
         n_closed)
      type(mesh_type), intent(in) :: mesh
      type(topology_type), intent(in) :: topology
      real(wp), intent(in) :: factor(:)            !! (>= n_elements) F_k [-]
      real(wp), intent(in) :: normal(:, :)         !! (2, >= n_elements) as in `failure_map`
      type(rules_type), intent(in) :: rules
      real(wp), intent(inout) :: retry(:)          !! (n_nodes) F_p below which a node is left alone
      type(crack_type), allocatable, intent(out) :: cracks(:)
      integer, intent(out) :: n_waiting            !! failed nodes put off by a lock or the limit
      integer, intent(out) :: n_closed             !! of those looked at, with no way for a crack

      integer, allocatable :: nodes(:), order(:)
      type(nodal_failure_type), allocatable :: failures(:)
      type(arm_type), allocatable :: arms(:)
      type(fan_type) :: fan
      type(crack_type), allocatable :: planned(:)
      logical, allocatable :: locked(:)
      integer :: i, n

      n_closed = 0
      n = 0
      call find_failed(mesh, topology, factor, normal, rules, retry, nodes, failures)
      allocate (planned(min(size(nodes), rules%most_cracks)))
      allocate (locked(merge(mesh%n_elements, 0, size(nodes) > 0)), source=.false.)
      order = descending(failures%factor)
      do i = 1, size(nodes)
         associate (node => nodes(order(i)), failure => failures(order(i)))
            if (n == size(planned)) exit
            call fan_of_node(mesh, topology, node, fan)
            call choose_arms(mesh, topology, fan, failure%along, rules%mode, rules%guard, arms)
            if (size(arms) == 0) then
               n_closed = n_closed + 1
               retry(node) = worth_another_look*failure%factor
            else if (.not. any(locked(touched_elements(topology, fan, arms)))) then
               locked(touched_elements(topology, fan, arms)) = .true.
               n = n + 1
               planned(n) = crack_type(node, failure, arms)
            end if
         end associate
      end do
      cracks = planned(:n)
      n_waiting = size(nodes) - n - n_closed
   end subroutine plan_cracks

   !> Nodes with F_p >= 1, or what the rules say, ascending, and what failed there.
   pure subroutine find_failed(mesh, topology, factor, normal, rules, retry, nodes, failures)
      type(mesh_type), intent(in) :: mesh
      type(topology_type), intent(in) :: topology
      real(wp), intent(in) :: factor(:)
      real(wp), intent(in) :: normal(:, :)
      type(rules_type), intent(in) :: rules
      real(wp), intent(in) :: retry(:)
      integer, allocatable, intent(out) :: nodes(:)
      type(nodal_failure_type), allocatable, intent(out) :: failures(:)

      logical, allocatable :: near(:)
      type(fan_type) :: fan
      type(nodal_failure_type) :: failure
      integer :: element, node, n

      allocate (near(mesh%n_nodes), source=.false.)
      do element = 1, mesh%n_elements
         if (.not. topology%alive(element) .or. .not. factor(element) >= 1.0_wp) cycle
         near(mesh%triangles(:, element)) = .true.
      end do
      allocate (nodes(count(near)), failures(count(near)))
      n = 0
      do node = 1, mesh%n_nodes
         if (.not. near(node)) cycle
         call fan_of_node(mesh, topology, node, fan)
         if (.not. mean_factor(mesh, factor, rules%weights, fan) &
            >= max(rules%least_factor, retry(node))) cycle
         call average_at_node(mesh, topology, node, factor, normal, rules%weights, fan, failure)
         if (.not. failure%agreement > 0.0_wp) cycle
         n = n + 1
         nodes(n) = node
         failures(n) = failure
      end do
      nodes = nodes(:n)
      failures = failures(:n)
   end subroutine find_failed

   !> Elements of the fan, and those cut from the other side.
   pure function touched_elements(topology, fan, arms) result(elements)
      type(topology_type), intent(in) :: topology
      type(fan_type), intent(in) :: fan
      type(arm_type), intent(in) :: arms(:)
      integer, allocatable :: elements(:)

      integer :: i, other

      elements = fan%element(:fan%n)
      do i = 1, size(arms)
         if (.not. arms(i)%through) cycle
         other = topology%neighbour(arms(i)%edge, arms(i)%element)
         if (other > 0) elements = [elements, other]
      end do
   end function touched_elements

   !> Places of the values from the largest down; equal ones keep their order (merge sort).
   pure function descending(values) result(order)
      real(wp), intent(in) :: values(:)
      integer :: order(size(values))

      integer :: merged(size(values)), width, low, middle, high, i, left, right

      order = [(i, i=1, size(values))]
      width = 1
      do while (width < size(values))
         do low = 1, size(values), 2*width
            middle = min(low + width, size(values) + 1)
            high = min(low + 2*width, size(values) + 1)
            left = low
            right = middle
            do i = low, high - 1
               if (takes_left(left, right)) then
                  merged(i) = order(left)
                  left = left + 1
               else
                  merged(i) = order(right)
                  right = right + 1
               end if
            end do
         end do
         order = merged
         width = 2*width
      end do

   contains

      pure function takes_left(left, right) result(yes)
         integer, intent(in) :: left
         integer, intent(in) :: right
         logical :: yes

         yes = right >= high
         if (left >= middle .or. yes) return
         yes = values(order(left)) >= values(order(right))
      end function takes_left

   end function descending

end module lithofrac_fracture_plan
