!> Non-local failure map: failure factors and fracture directions averaged at the nodes
!> (Klerck, Sellers & Owen 2004, section 2.5, eqs 21 and 22).
!>
!> Directions have period pi: they are averaged as (cos 2 theta, sin 2 theta), so 1 and 179
!> degrees give 0, not 90. This module knows nothing of the state of the material beyond a
!> factor and a direction an element.
module lithofrac_fracture_failure_map
   use lithofrac_base_kinds, only: wp
   use lithofrac_mesh_mesh, only: mesh_type, triangle_area
   use lithofrac_mesh_rings, only: fan_of_node, fan_type
   use lithofrac_mesh_topology, only: topology_type
   implicit none
   private

   public :: nodal_failure_type, average_at_node, failure_factor, largest_factor, mean_factor
   public :: by_volume, by_failure_factor

   integer, parameter :: by_volume = 0           !! "usually taken as the element volume"
   integer, parameter :: by_failure_factor = 1   !! volume times failure factor

   real(wp), parameter :: largest_factor = 10.0_wp  !! keeps one element from ruling its node
   real(wp), parameter :: least_agreement = 0.3_wp  !! below it directions conflict

   !> What a node has of eq. 22.
   type :: nodal_failure_type
      real(wp) :: factor = 0.0_wp                 !! F_p [-], 1 and above: failed
      real(wp) :: along(2) = [1.0_wp, 0.0_wp]     !! unit vector of the crack, either sense
      real(wp) :: agreement = 0.0_wp              !! 0: directions cancel (or none), 1: all one
   end type nodal_failure_type

contains

   !> F_k of one tension plane (eq. 21): fracturing strain over the one that uses up Gf.
   !>
   !> It goes on beyond 1, because a mean reaches 1 only if some elements pass it. The
   !> out-of-plane one gives no direction in the plane: the caller leaves it out.
   elemental function failure_factor(opening, softening, ft) result(factor)
      real(wp), intent(in) :: opening    !! fracturing strain [-]
      real(wp), intent(in) :: softening  !! H of eq. 16, not positive [Pa]
      real(wp), intent(in) :: ft         !! virgin tensile strength [Pa]
      real(wp) :: factor

      factor = 0.0_wp
      if (ft > 0.0_wp) factor = min(largest_factor, max(0.0_wp, -softening*opening/ft))
   end function failure_factor

   !> Weighted averages over the elements at a node (eq. 22).
   !>
   !> Softening directions come as vectors at twice their angle, of any length. Elements that
   !> have not begun to fail count in the factor but have no direction. Where
   !> directions conflict, the element with the largest factor decides (of equals the lowest).
   !> Choice: weights are reference volumes, or volumes times failure factors, one set for both
   !> averages as in the paper (test_failure_map).
   pure subroutine average_at_node(mesh, topology, node, factor, normal, weights, fan, failure)
      type(mesh_type), intent(in) :: mesh
      type(topology_type), intent(in) :: topology
      integer, intent(in) :: node
      real(wp), intent(in) :: factor(:)       !! (>= n_elements) F_k [-]
      real(wp), intent(in) :: normal(:, :)    !! (2, >= n_elements) doubled softening direction
      integer, intent(in) :: weights          !! `by_volume` or `by_failure_factor`
      type(fan_type), intent(inout) :: fan    !! of the node, afterwards
      type(nodal_failure_type), intent(out) :: failure

      real(wp) :: mean(2), weight, sum_direction, largest, long, top(2)
      integer :: element, i

      call fan_of_node(mesh, topology, node, fan)
      failure%factor = mean_factor(mesh, factor, weights, fan)
      mean = 0.0_wp
      sum_direction = 0.0_wp
      largest = 0.0_wp
      top = 0.0_wp
      do i = 1, fan%n
         element = fan%element(i)
         long = norm2(normal(:, element))
         if (.not. (factor(element) > 0.0_wp .and. long > 0.0_wp)) cycle
         weight = weight_of(mesh, element, factor(element), weights)
         mean = mean + weight*normal(:, element)/long
         sum_direction = sum_direction + weight
         if (factor(element) <= largest) cycle
         largest = factor(element)
         top = normal(:, element)/long
      end do
      if (sum_direction <= 0.0_wp) return
      failure%agreement = norm2(mean)/sum_direction
      if (failure%agreement < least_agreement) mean = top
      failure%along = turned_half(-mean)
   end subroutine average_at_node

   !> F_p alone (eq. 22): most nodes need no direction, which costs more.
   pure function mean_factor(mesh, factor, weights, fan) result(mean)
      type(mesh_type), intent(in) :: mesh
      real(wp), intent(in) :: factor(:)       !! (>= n_elements) F_k [-]
      integer, intent(in) :: weights          !! `by_volume` or `by_failure_factor`
      type(fan_type), intent(in) :: fan       !! of the node
      real(wp) :: mean

      real(wp) :: weight, sum_factor, sum_weight
      integer :: i

      sum_factor = 0.0_wp
      sum_weight = 0.0_wp
      do i = 1, fan%n
         associate (element => fan%element(i))
            weight = weight_of(mesh, element, factor(element), weights)
            sum_weight = sum_weight + weight
            sum_factor = sum_factor + weight*factor(element)
         end associate
      end do
      mean = 0.0_wp
      if (sum_weight > 0.0_wp) mean = sum_factor/sum_weight
   end function mean_factor

   pure function weight_of(mesh, element, factor, weights) result(weight)
      type(mesh_type), intent(in) :: mesh
      integer, intent(in) :: element
      real(wp), intent(in) :: factor
      integer, intent(in) :: weights
      real(wp) :: weight

      associate (a => mesh%triangles(1, element), b => mesh%triangles(2, element), &
            c => mesh%triangles(3, element))
         weight = triangle_area(mesh%nodes(:, a), mesh%nodes(:, b), mesh%nodes(:, c))
      end associate
      if (weights == by_failure_factor) weight = weight*factor
   end function weight_of

   !> Unit vector at half the angle of a vector: (cos 2 a, sin 2 a) to (cos a, sin a), cos a >= 0.
   !>
   !> The crack runs across the direction of softening: 90 degrees, which is the opposite vector
   !> among doubled angles.
   pure function turned_half(double) result(single)
      real(wp), intent(in) :: double(2)  !! not zero
      real(wp) :: single(2)

      real(wp) :: angle

      angle = 0.5_wp*atan2(double(2), double(1))
      single = [cos(angle), sin(angle)]
   end function turned_half

end module lithofrac_fracture_failure_map
