!> What contact remembers between steps: boundary, list of candidates, impulses, statistics.
!>
!> This module knows boundary nodes only; `run` brings their motion.
module lithofrac_contact_contact
   use lithofrac_base_kinds, only: wp
   use lithofrac_base_status, only: bad_input, ok, set_failure, status_type
   use lithofrac_contact_corners, only: classify
   use lithofrac_contact_islands, only: find_islands, group_islands
   use lithofrac_contact_multipliers, only: queue_type
   use lithofrac_contact_pairs, only: motion_type, pair_type
   use lithofrac_contact_search, only: candidates_type, list_candidates
   use lithofrac_contact_slices, only: group_type, most_groups, most_slices, slice_type
   use lithofrac_contact_surfaces, only: new_surfaces, surfaces_type
   use lithofrac_mesh_mesh, only: mesh_type
   implicit none
   private

   public :: contact_type, corner_of_edge, find_groups, has_turned, new_contact, prepare_list
   public :: renew_list, resize_motion, statistics_type, turn_corners

   real(wp), parameter :: rotated = 1.0e-6_wp      !! squared turn that asks for new corners [rad2]

   type :: statistics_type
      integer :: pairs_max = 0
      integer :: steps = 0                         !! with at least one pair
      integer :: sweeps = 0
      integer :: unconverged = 0                   !! steps
      integer :: lists = 0                         !! times the list was made
      real(wp) :: penetration = 0.0_wp             !! deepest, over h
   end type statistics_type

   !> What is read of a boundary node before and after the sweeps.
   type :: record_type
      real(wp) :: before(2) = 0.0_wp               !! velocity at the half step before [m/s]
      real(wp) :: impulse(2) = 0.0_wp              !! of all its pairs in this step [N s]
   end type record_type

   type :: contact_type
      logical :: on = .false.
      type(surfaces_type) :: surfaces
      real(wp), allocatable :: friction(:, :)      !! (n_tags, n_tags)
      real(wp) :: tolerance = 1.0_wp               !! of sweeps and penetration, over the usual one
      type(candidates_type) :: candidates
      integer, allocatable :: near(:)              !! boundary nodes and edges of the candidates
      integer, allocatable :: kind(:)              !! (n_corners)
      integer, allocatable :: face(:, :)           !! (2, n_corners)
      logical, allocatable :: neighbours(:)        !! (n_corners) nothing stands between
      real(wp), allocatable :: corner_friction(:)  !! (n_corners)
      real(wp), allocatable :: edge_friction(:)    !! (n_edges)
      real(wp), allocatable :: tangent(:, :)       !! (2, n) edges when corners were classified
      real(wp), allocatable :: corner_impulse(:, :)  !! (2, n_corners) normal, tangential [N s]
      real(wp), allocatable :: edge_impulse(:, :)  !! (2, n_edges)
      type(pair_type), allocatable :: pairs(:)     !! room for every candidate, and one a slice
      real(wp), allocatable :: work(:, :)          !! (4, pairs) normal, friction; then after [J]
      integer, allocatable :: order(:)             !! pairs of the step, group by group
      integer, allocatable :: pair_group(:)        !! group of islands of each pair
      integer :: n_pairs = 0
      integer, allocatable :: group_of(:)          !! (n) group of islands of a node
      integer :: n_slices = 1                      !! of this step
      type(slice_type) :: slices(most_slices)
      integer :: n_groups = 0                      !! 0: islands of the list are not known yet
      type(group_type) :: groups(most_groups)
      integer, allocatable :: first_edge(:)        !! (0:n_corners + 1) into `edge_order`
      integer, allocatable :: edge_order(:)        !! node-edge pairs by their corner, 0 for none
      integer, allocatable :: keeper(:)            !! (0:n_corners) who keeps the two nodes apart
      integer, allocatable :: beside(:)            !! (n) corner pairs of a node in this step
      type(queue_type) :: queue
      type(motion_type), allocatable :: motion(:)  !! (n)
      type(record_type), allocatable :: record(:)  !! (n)
      integer :: n_loaded = -1                     !! pairs of the step before; -1: not known
      integer, allocatable :: loaded(:)            !! their candidates
      real(wp) :: work_before(2) = 0.0_wp          !! normal, friction: half step before [J]
      real(wp) :: work_after(2) = 0.0_wp           !! and after [J]
      type(statistics_type) :: statistics
   end type contact_type

contains

   !> Prepare the boundary of a mesh for contact.
   subroutine new_contact(contact, mesh, friction, tolerance, status)
      type(contact_type), intent(out) :: contact
      type(mesh_type), intent(in) :: mesh
      real(wp), intent(in) :: friction(:, :)   !! by surface tag; bodies are the first tags
      real(wp), intent(in) :: tolerance        !! of sweeps and penetration, over the usual one
      type(status_type), intent(out) :: status

      if (size(friction, 1) < mesh%n_bodies) then
         call set_failure(status, bad_input, "contact: a body has no friction")
      else if (.not. all(friction >= 0.0_wp .and. friction <= huge(1.0_wp))) then
         call set_failure(status, bad_input, "contact: friction is a finite number >= 0")
      else if (any(abs(friction - transpose(friction)) > 0.0_wp)) then
         call set_failure(status, bad_input, "contact: friction must be symmetric")
      else if (.not. (tolerance > 0.0_wp .and. tolerance <= huge(1.0_wp))) then
         call set_failure(status, bad_input, "contact: tolerance is a finite number > 0")
      end if
      if (status%code /= ok) return
      call new_surfaces(contact%surfaces, mesh, status)
      if (status%code /= ok) return
      contact%friction = friction
      contact%tolerance = tolerance
      call resize_motion(contact)
      contact%on = .true.
   end subroutine new_contact

   !> Room for the motion of every boundary node; nothing is kept.
   subroutine resize_motion(contact)
      type(contact_type), intent(inout) :: contact

      if (allocated(contact%motion)) deallocate (contact%motion, contact%record, contact%beside, &
         contact%queue%newest)
      associate (n => contact%surfaces%n)
         allocate (contact%motion(n), contact%record(n))
         allocate (contact%beside(n), contact%queue%newest(n), source=0)
      end associate
      contact%tangent = contact%surfaces%tangent
      contact%candidates%u = contact%surfaces%u
   end subroutine resize_motion

   !> A new list of candidates; impulses go along.
   subroutine renew_list(contact)
      type(contact_type), intent(inout) :: contact

      type(candidates_type) :: old
      real(wp), allocatable :: corner_impulse(:, :), edge_impulse(:, :)

      call move_alloc(contact%candidates%corner, old%corner)
      call move_alloc(contact%candidates%edge, old%edge)
      if (allocated(old%corner)) then
         call move_alloc(contact%corner_impulse, corner_impulse)
         call move_alloc(contact%edge_impulse, edge_impulse)
      end if
      contact%tangent = contact%surfaces%tangent
      call prepare_list(contact)
      if (allocated(old%corner)) then
         call carry_over(old%corner, corner_impulse, contact%candidates%corner, &
            contact%corner_impulse)
         call carry_over(old%edge, edge_impulse, contact%candidates%edge, contact%edge_impulse)
      end if
      contact%statistics%lists = contact%statistics%lists + 1
   end subroutine renew_list

   !> List for `surfaces%u` with corners for `tangent`: all that is not saved in a checkpoint.
   subroutine prepare_list(contact)
      type(contact_type), intent(inout) :: contact

      integer :: n_corners, n_edges, n_all, i

      call list_candidates(contact%candidates, contact%surfaces)
      n_corners = size(contact%candidates%corner, 2)
      n_edges = size(contact%candidates%edge, 2)
      if (allocated(contact%kind)) then
         deallocate (contact%kind, contact%face, contact%pairs, contact%work, contact%order, &
            contact%pair_group)
         deallocate (contact%neighbours, contact%corner_friction, contact%edge_friction)
         deallocate (contact%keeper, contact%first_edge, contact%queue%next, contact%queue%now, &
            contact%queue%older, contact%loaded)
      end if
      allocate (contact%kind(n_corners), contact%face(2, n_corners))
      allocate (contact%neighbours(n_corners))
      allocate (contact%corner_friction(n_corners), contact%edge_friction(n_edges))
      n_all = n_corners + n_edges + 2*most_slices
      allocate (contact%pairs(n_all), contact%work(4, n_all), contact%queue%older(4, n_all))
      allocate (contact%queue%next(n_all), contact%queue%now(n_all), contact%order(n_all))
      allocate (contact%loaded(n_all), contact%pair_group(n_all))
      allocate (contact%keeper(0:n_corners), contact%first_edge(0:n_corners + 1))
      contact%keeper = 0
      contact%corner_impulse = spread([0.0_wp, 0.0_wp], 2, n_corners)
      contact%edge_impulse = spread([0.0_wp, 0.0_wp], 2, n_edges)
      associate (list => contact%candidates, prev => contact%surfaces%prev)
         do i = 1, n_corners
            call classify_corner(contact, i)
            contact%corner_friction(i) = friction_of(contact, [prev(list%corner(1, i)), &
               list%corner(1, i)], [prev(list%corner(2, i)), list%corner(2, i)])
         end do
         do i = 1, n_edges
            contact%edge_friction(i) = friction_of(contact, [prev(list%edge(1, i)), &
               list%edge(1, i)], [list%edge(2, i)])
         end do
      end associate
      call order_edges(contact)
      call find_near(contact)
      contact%n_groups = 0
      contact%n_loaded = -1
   end subroutine prepare_list

   !> Groups of islands that are solved at the same time. No bit depends on their number.
   subroutine find_groups(contact, n_groups)
      type(contact_type), intent(inout) :: contact
      integer, intent(in) :: n_groups

      integer, allocatable :: island(:), weight(:)
      integer :: i

      allocate (island(contact%surfaces%n), weight(contact%surfaces%n))
      weight = 0
      associate (list => contact%candidates)
         call find_islands(contact%surfaces, list, island)
         do i = 1, size(list%corner, 2)
            weight(list%corner(1, i)) = weight(list%corner(1, i)) + 1
         end do
         do i = 1, size(list%edge, 2)
            weight(list%edge(1, i)) = weight(list%edge(1, i)) + 1
         end do
      end associate
      if (allocated(contact%group_of)) deallocate (contact%group_of)
      allocate (contact%group_of(contact%surfaces%n))
      contact%n_groups = n_groups
      call group_islands(island, weight, n_groups, contact%group_of)
   end subroutine find_groups

   !> Sort the node-edge pairs by a corner that the node makes with an end of the edge: while that
   !> corner has a pair nobody needs to look at them.
   pure subroutine order_edges(contact)
      type(contact_type), intent(inout) :: contact

      integer :: place(0:size(contact%kind)), i, corner

      associate (list => contact%candidates, first => contact%first_edge)
         first = 0
         do i = 1, size(list%edge, 2)
            corner = corner_of_edge(list, i)
            first(corner + 1) = first(corner + 1) + 1
         end do
         first(0) = 1
         do corner = 0, size(contact%kind)
            place(corner) = first(corner)
            first(corner + 1) = first(corner + 1) + first(corner)
         end do
         if (allocated(contact%edge_order)) deallocate (contact%edge_order)
         allocate (contact%edge_order(size(list%edge, 2)))
         do i = 1, size(list%edge, 2)
            corner = corner_of_edge(list, i)
            contact%edge_order(place(corner)) = i
            place(corner) = place(corner) + 1
         end do
      end associate
   end subroutine order_edges

   !> The corner by which a node-edge pair is sorted; 0 for none.
   pure function corner_of_edge(list, i) result(corner)
      type(candidates_type), intent(in) :: list
      integer, intent(in) :: i
      integer :: corner

      corner = list%corner_at(merge(1, 2, list%corner_at(1, i) > 0), i)
   end function corner_of_edge

   !> Boundary nodes that a pair of the list may move, and edges that it may look at, ascending.
   pure subroutine find_near(contact)
      type(contact_type), intent(inout) :: contact

      logical :: is_near(contact%surfaces%n)
      integer :: i

      is_near = .false.
      associate (list => contact%candidates, prev => contact%surfaces%prev, &
            next => contact%surfaces%next)
         do i = 1, size(list%corner, 2)
            is_near(list%corner(:, i)) = .true.
            is_near(prev(list%corner(:, i))) = .true.
            is_near(next(list%corner(:, i))) = .true.
         end do
         do i = 1, size(list%edge, 2)
            is_near(list%edge(:, i)) = .true.
            is_near(next(list%edge(2, i))) = .true.
            is_near(prev(list%edge(2, i))) = .true.
         end do
      end associate
      contact%near = pack([(i, i=1, size(is_near))], is_near)
   end subroutine find_near

   !> Copy the values of pairs that are in both lists; both are sorted.
   pure subroutine carry_over(old_pair, old_value, new_pair, new_value)
      integer, intent(in) :: old_pair(:, :)
      real(wp), intent(in) :: old_value(:, :)
      integer, intent(in) :: new_pair(:, :)
      real(wp), intent(inout) :: new_value(:, :)

      integer :: i, k

      k = 1
      do i = 1, size(new_pair, 2)
         do while (k <= size(old_pair, 2))
            if (old_pair(1, k) > new_pair(1, i)) exit
            if (old_pair(1, k) == new_pair(1, i) .and. old_pair(2, k) >= new_pair(2, i)) exit
            k = k + 1
         end do
         if (k > size(old_pair, 2)) exit
         if (all(old_pair(:, k) == new_pair(:, i))) new_value(:, i) = old_value(:, k)
      end do
   end subroutine carry_over

   pure subroutine classify_corner(contact, i)
      type(contact_type), intent(inout) :: contact
      integer, intent(in) :: i

      associate (first => contact%candidates%corner(1, i), t => contact%tangent, &
            second => contact%candidates%corner(2, i), prev => contact%surfaces%prev)
         call classify(t(:, prev(first)), t(:, first), t(:, prev(second)), t(:, second), &
            contact%kind(i), contact%face(:, i), contact%neighbours(i))
      end associate
   end subroutine classify_corner

   !> Classify corners again where an edge has turned since the last time.
   pure subroutine turn_corners(contact)
      type(contact_type), intent(inout) :: contact

      logical :: turned(contact%surfaces%n)
      integer :: i, k

      turned = .false.
      associate (t => contact%surfaces%tangent, old => contact%tangent)
         do k = 1, size(contact%near)
            i = contact%near(k)
            turned(i) = turn_of(t(1, i), t(2, i), old(1, i), old(2, i)) > rotated
            if (turned(i)) old(:, i) = t(:, i)
         end do
      end associate
      associate (corner => contact%candidates%corner, prev => contact%surfaces%prev)
         do i = 1, size(corner, 2)
            associate (a => corner(1, i), b => corner(2, i))
               if (turned(a) .or. turned(b) .or. turned(prev(a)) .or. turned(prev(b))) then
                  call classify_corner(contact, i)
               end if
            end associate
         end do
      end associate
   end subroutine turn_corners

   !> Has one of these edges turned since corners were classified?
   pure function has_turned(contact, edge)
      type(contact_type), intent(in) :: contact
      integer, intent(in), contiguous :: edge(:)
      logical :: has_turned

      integer :: i, k

      has_turned = .true.
      associate (t => contact%surfaces%tangent, old => contact%tangent)
         do k = 1, size(edge)
            i = edge(k)
            if (turn_of(t(1, i), t(2, i), old(1, i), old(2, i)) > rotated) return
         end do
      end associate
      has_turned = .false.
   end function has_turned

   !> Squared angle between two unit vectors, small [rad2].
   pure function turn_of(x, y, old_x, old_y) result(turn)
      real(wp), intent(in) :: x, y
      real(wp), intent(in) :: old_x, old_y
      real(wp) :: turn

      turn = (x - old_x)**2 + (y - old_y)**2
   end function turn_of

   !> Choice: where faces of different friction meet in a corner, the largest holds.
   pure function friction_of(contact, first, second) result(friction)
      type(contact_type), intent(in) :: contact
      integer, intent(in) :: first(:)    !! edges at the one side
      integer, intent(in) :: second(:)   !! and at the other
      real(wp) :: friction

      friction = maxval(contact%friction(contact%surfaces%tag(first), &
         contact%surfaces%tag(second)))
   end function friction_of

end module lithofrac_contact_contact
