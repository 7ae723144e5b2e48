!> Which way a crack leaves its node: along existing edges, or through elements
!> (Klerck, Sellers & Owen 2004, section 2.5, Fig. 4).
!>
!> A pure choice on the mesh as it is; `mesh/split` carries it out. Directions are compared in
!> the reference configuration, where the material keeps its axes.
module lithofrac_fracture_arms
   use lithofrac_base_kinds, only: pi, wp
   use lithofrac_mesh_cut, only: assess_cut, guard_type, sound
   use lithofrac_mesh_mesh, only: mesh_type
   use lithofrac_mesh_rings, only: fan_type, on_boundary
   use lithofrac_mesh_split, only: arm_type
   use lithofrac_mesh_topology, only: corner_of, next_corner, topology_type
   implicit none
   private

   public :: choose_arms
   public :: inter_element, intra_element

   integer, parameter :: inter_element = 1   !! along existing edges only, Fig. 4c
   integer, parameter :: intra_element = 2   !! through elements where the guards allow, Fig. 4b

   real(wp), parameter :: least_spread = pi/3.0_wp  !! between the two arms of an inner node [rad]
   real(wp), parameter :: largest_turn = pi/4.0_wp  !! of a single arm out of its direction [rad]
   real(wp), parameter :: equal_angles = 1.0e-9_wp  !! angles closer than this are a tie [rad]

   !> A way out of the node.
   type :: way_type
      type(arm_type) :: arm
      real(wp) :: angle = 0.0_wp      !! position around the node [rad]
      integer :: far = huge(0)        !! node at its end; a new one comes last in a tie
      logical :: meets = .false.      !! its end lies on a boundary or a crack
      logical :: crosses = .false.    !! goes through an element: open to its own ray alone
      integer :: ray = 0              !! which ray it follows if it crosses
   end type way_type

contains

   !> Choose two arms at an inner node, one at a boundary node; none if there is no way.
   !>
   !> At an inner node they are the pair of ways nearest to the two senses of `along`, at least
   !> 60 degrees apart (a crack through an element follows its direction exactly). At a boundary
   !> node, where one arm opens the crack, it follows the sense that points deeper into the
   !> material, and not further than 45 degrees off: what runs along the boundary is no crack.
   !> Of equal ways the one that ends at a boundary or a crack tip is taken, then the straighter
   !> pair, then the one with the lower end node.
   pure subroutine choose_arms(mesh, topology, fan, along, mode, guard, arms)
      type(mesh_type), intent(in) :: mesh
      type(topology_type), intent(in) :: topology
      type(fan_type), intent(in) :: fan                    !! of the node
      real(wp), intent(in) :: along(2)                     !! unit vector
      integer, intent(in) :: mode                          !! `inter_element` or `intra_element`
      type(guard_type), intent(in) :: guard
      type(arm_type), allocatable, intent(out) :: arms(:)  !! 0, 1 or 2

      type(way_type) :: ways(fan%n + 3)
      real(wp) :: angles(fan%n + 1), rays(2)
      integer :: sector(2), n, i, best(2)

      call measure_fan(mesh, fan, along, angles, sector, rays)
      n = 0
      do i = merge(1, 2, fan%closed), fan%n
         n = n + 1
         ways(n)%arm%element = fan%element(i)
         ways(n)%arm%edge = fan%corner(i)
         ways(n)%angle = angles(i)
         ways(n)%far = fan%rim(i)
         ways(n)%meets = on_boundary(mesh, topology, fan%rim(i))
      end do
      if (mode == intra_element) then
         do i = 1, 2
            call add_crossing(mesh, topology, fan, merge(along, -along, i == 1), i, sector(i), &
               rays(i), guard, ways, n)
         end do
      end if
      if (fan%closed) then
         best = best_pair(ways(:n), rays)
      else
         best = [best_single(ways(:n), angles(fan%n + 1), sector, rays), 0]
      end if
      arms = ways(pack(best, best > 0))%arm
      if (size(arms) == 2) then
         if (arms(1)%element == arms(2)%element) then
            arms = seen_from_outside(mesh, topology, arms)
         end if
      end if
   end subroutine choose_arms

   !> An edge of an element that the other arm cuts is named from its other side, which stays.
   pure elemental function seen_from_outside(mesh, topology, arm) result(seen)
      type(mesh_type), intent(in) :: mesh
      type(topology_type), intent(in) :: topology
      type(arm_type), intent(in) :: arm
      type(arm_type) :: seen

      seen = arm
      if (arm%through) return
      seen%element = topology%neighbour(arm%edge, arm%element)
      seen%edge = corner_of(mesh, seen%element, &
         mesh%triangles(next_corner(arm%edge), arm%element))
   end function seen_from_outside

   !> Angles of the spokes, counter-clockwise from the first, and of the rays along +-`along`.
   pure subroutine measure_fan(mesh, fan, along, angles, sector, rays)
      type(mesh_type), intent(in) :: mesh
      type(fan_type), intent(in) :: fan
      real(wp), intent(in) :: along(2)
      real(wp), intent(out) :: angles(:)    !! (fan%n + 1) [rad]
      integer, intent(out) :: sector(2)     !! element of the fan that each ray enters, 0: none
      real(wp), intent(out) :: rays(2)      !! [rad]

      real(wp) :: origin(2), a(2), b(2), t(2)
      integer :: i, ray

      origin = mesh%nodes(:, mesh%triangles(fan%corner(1), fan%element(1)))
      angles(1) = 0.0_wp
      sector = 0
      rays = 0.0_wp
      do i = 1, fan%n
         a = mesh%nodes(:, fan%rim(i)) - origin
         b = mesh%nodes(:, fan%rim(i + 1)) - origin
         angles(i + 1) = angles(i) + angle_between(a, b)
         do ray = 1, 2
            t = merge(along, -along, ray == 1)
            if (cross(a, t) < 0.0_wp .or. cross(t, b) <= 0.0_wp .or. sector(ray) > 0) cycle
            sector(ray) = i
            rays(ray) = angles(i) + angle_between(a, t)
         end do
      end do
   end subroutine measure_fan

   !> Offer the way through the element that a ray enters, if it may be cut there.
   pure subroutine add_crossing(mesh, topology, fan, t, ray, sector, angle, guard, ways, n)
      type(mesh_type), intent(in) :: mesh
      type(topology_type), intent(in) :: topology
      type(fan_type), intent(in) :: fan
      real(wp), intent(in) :: t(2)
      integer, intent(in) :: ray
      integer, intent(in) :: sector
      real(wp), intent(in) :: angle
      type(guard_type), intent(in) :: guard
      type(way_type), intent(inout) :: ways(:)
      integer, intent(inout) :: n

      real(wp) :: origin(2), a, b, s
      integer :: edge

      if (sector == 0) return
      origin = mesh%nodes(:, mesh%triangles(fan%corner(sector), fan%element(sector)))
      a = cross(mesh%nodes(:, fan%rim(sector)) - origin, t)
      b = cross(t, mesh%nodes(:, fan%rim(sector + 1)) - origin)
      s = a/(a + b)
      edge = next_corner(fan%corner(sector))
      if (assess_cut(mesh, topology, fan%element(sector), edge, s, guard) /= sound) return
      n = n + 1
      ways(n) = way_type(arm_type(fan%element(sector), edge, .true., s), angle, crosses=.true., &
         ray=ray)
   end subroutine add_crossing

   !> The two ways of an inner node, one a ray: least sum of the angles off.
   pure function best_pair(ways, rays) result(best)
      type(way_type), intent(in) :: ways(:)
      real(wp), intent(in) :: rays(2)
      integer :: best(2)              !! 0, 0 if no two are far enough apart

      integer :: i, j
      real(wp) :: off, least

      best = 0
      least = huge(1.0_wp)
      do i = 1, size(ways)
         do j = 1, size(ways)
            if (apart(ways(i)%angle, ways(j)%angle) < least_spread) cycle
            if (ways(i)%crosses .and. ways(i)%ray /= 1) cycle
            if (ways(j)%crosses .and. ways(j)%ray /= 2) cycle
            off = apart(ways(i)%angle, rays(1)) + apart(ways(j)%angle, rays(2))
            if (off > least + equal_angles) cycle
            if (off >= least - equal_angles) then
               if (.not. precedes(ways([i, j]), ways(best))) cycle
            end if
            least = off
            best = [i, j]
         end do
      end do
   end function best_pair

   !> The way of a boundary node that follows its deeper ray (either if they are equally deep);
   !> 0 if there is none.
   pure function best_single(ways, opening, sector, rays) result(best)
      type(way_type), intent(in) :: ways(:)
      real(wp), intent(in) :: opening   !! angle of the material at the node [rad]
      integer, intent(in) :: sector(2)
      real(wp), intent(in) :: rays(2)
      integer :: best

      integer :: i, ray
      real(wp) :: depth(2), off, least

      best = 0
      depth = merge(min(rays, opening - rays), -1.0_wp, sector > 0)
      least = huge(1.0_wp)
      do ray = 1, 2
         if (sector(ray) == 0 .or. depth(ray) < maxval(depth) - equal_angles) cycle
         do i = 1, size(ways)
            if (ways(i)%crosses .and. ways(i)%ray /= ray) cycle
            off = abs(ways(i)%angle - rays(ray))
            if (off > min(least + equal_angles, largest_turn)) cycle
            if (off >= least - equal_angles) then
               if (.not. precedes(ways([i]), ways([best]))) cycle
            end if
            least = off
            best = i
         end do
      end do
   end function best_single

   !> Which of two equally good choices: more ends on boundaries, then the straighter one, then
   !> lower end nodes.
   pure function precedes(new, old) result(yes)
      type(way_type), intent(in) :: new(:)
      type(way_type), intent(in) :: old(:)
      logical :: yes

      real(wp) :: bend

      yes = count(new%meets) > count(old%meets)
      if (count(new%meets) /= count(old%meets)) return
      bend = apart(old(1)%angle, old(size(old))%angle) - apart(new(1)%angle, new(size(new))%angle)
      yes = bend < 0.0_wp
      if (abs(bend) > equal_angles) return
      yes = minval(new%far) < minval(old%far)
      if (minval(new%far) == minval(old%far)) yes = maxval(new%far) < maxval(old%far)
   end function precedes

   !> Angle between two directions around a closed fan [rad].
   pure elemental function apart(a, b) result(angle)
      real(wp), intent(in) :: a  !! [rad]
      real(wp), intent(in) :: b  !! [rad]
      real(wp) :: angle

      angle = abs(a - b)
      angle = min(angle, 2.0_wp*pi - angle)
   end function apart

   !> Counter-clockwise angle from `a` to `b` [rad].
   pure function angle_between(a, b) result(angle)
      real(wp), intent(in) :: a(2)
      real(wp), intent(in) :: b(2)
      real(wp) :: angle

      angle = atan2(cross(a, b), dot_product(a, b))
   end function angle_between

   pure function cross(a, b) result(product)
      real(wp), intent(in) :: a(2)
      real(wp), intent(in) :: b(2)
      real(wp) :: product

      product = a(1)*b(2) - a(2)*b(1)
   end function cross

end module lithofrac_fracture_arms
