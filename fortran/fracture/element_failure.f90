!> Failure factors and softening directions of the elements, from the state of their material
!> (Klerck, Sellers & Owen 2004, eqs 13 and 21), and what failed elements regain at a crack.
module lithofrac_fracture_element_failure
   use lithofrac_base_kinds, only: wp
   use lithofrac_base_sums, only: ordered_sums
   use lithofrac_fracture_failure_map, only: failure_factor, largest_factor
   use lithofrac_material_rock, only: rock_type
   use lithofrac_mechanics_chunks, only: chunks_type, width
   use lithofrac_mechanics_fields, only: inelastic_type
   implicit none
   private

   public :: any_failed, normal_reset, paper_reset, reset_element, set_failure_factors

   integer, parameter :: normal_reset = 0  !! the count of failure across the crack alone
   integer, parameter :: paper_reset = 1   !! all state variables

contains

   !> Has any element used up its fracture energy in the plane, and how far have such elements
   !> gone in all? While the sum stands still, the failure map does as well: both end at the
   !> largest factor, so elements that are far beyond it ask for no new map.
   pure function any_failed(chunks, rocks, state) result(sum_of_factors)
      type(chunks_type), intent(in) :: chunks
      type(rock_type), intent(in) :: rocks(:)        !! (n_bodies)
      type(inelastic_type), intent(in) :: state
      real(wp) :: sum_of_factors                     !! of elements beyond 1, 0: none

      integer :: chunk, i
      real(wp) :: factor, terms(width), part

      sum_of_factors = 0.0_wp
      do chunk = 1, chunks%n_chunks
         if (.not. state%touched(chunk)) cycle
         associate (rock => rocks(chunks%body(chunk)))
            !$omp simd private(factor)
            do i = 1, width
               factor = -state%softening(i, chunk)*max(state%opening(i, 1, chunk), &
                  state%opening(i, 2, chunk))
               terms(i) = merge(min(factor, largest_factor*rock%tensile_strength), 0.0_wp, &
                  factor >= rock%tensile_strength)
            end do
            part = sum(ordered_sums(width, 1, terms))
            if (rock%tensile_strength > 0.0_wp) then
               sum_of_factors = sum_of_factors + part/rock%tensile_strength
            end if
         end associate
      end do
   end function any_failed

   !> F_k and doubled softening direction of every element; out-of-plane cracks have no
   !> direction in the plane and are left out.
   pure subroutine set_failure_factors(chunks, rocks, state, factor, normal)
      type(chunks_type), intent(in) :: chunks
      type(rock_type), intent(in) :: rocks(:)        !! (n_bodies)
      type(inelastic_type), intent(in) :: state
      real(wp), intent(out) :: factor(:)             !! (n_elements) [-]
      real(wp), intent(out) :: normal(:, :)          !! (2, n_elements) as in `failure_map`

      integer :: chunk, lane, element

      factor = 0.0_wp
      normal = 0.0_wp
      do chunk = 1, chunks%n_chunks
         if (.not. state%touched(chunk)) cycle
         do lane = 1, chunks%filled(chunk)
            element = chunks%element(lane, chunk)
            factor(element) = failure_factor(maxval(state%opening(lane, :2, chunk)), &
               state%softening(lane, chunk), rocks(chunks%body(chunk))%tensile_strength)
            normal(:, element) = state%crack(lane, :, chunk)
         end do
      end do
   end subroutine set_failure_factors

   !> Damage of a failed element goes over into the crack. The stress stays as it is. Energy that
   !> was dissipated stays booked.
   !>
   !> Choice: `normal_reset` begins to count anew across the crack and gives no strength back.
   !> Along an open crack nothing can be pulled; at a tip, where elements still hold both sides
   !> together, regained strength takes Gf a second time (test_fracture_bars). `paper_reset` is
   !> the paper's, which heals all state variables.
   pure subroutine reset_element(chunks, element, rock, along, reset, state, regained)
      type(chunks_type), intent(in) :: chunks
      integer, intent(in) :: element
      type(rock_type), intent(in) :: rock
      real(wp), intent(in) :: along(2)               !! unit vector of the crack
      integer, intent(in) :: reset                   !! `normal_reset` or `paper_reset`
      type(inelastic_type), intent(inout) :: state
      real(wp), intent(out) :: regained              !! fracture energy to spend again [J]

      real(wp) :: across
      integer :: plane, chunk, lane

      chunk = chunks%chunk_of(element)
      lane = chunks%lane_of(element)
      regained = 0.0_wp
      ! twice the angle of the crack normal is opposite to twice the angle of the crack
      across = -(state%axis(lane, 1, chunk)*(along(1)**2 - along(2)**2) &
         + state%axis(lane, 2, chunk)*2.0_wp*along(1)*along(2))
      do plane = 1, merge(3, 2, reset == paper_reset)
         if (reset == normal_reset .and. (plane == 1 .neqv. across >= 0.0_wp)) cycle
         state%opening(lane, plane, chunk) = 0.0_wp
         if (reset == normal_reset) cycle
         if (state%softening(lane, chunk) < 0.0_wp) regained = regained + 0.5_wp &
            *(rock%tensile_strength**2 - state%ft(lane, plane, chunk)**2) &
            /(-state%softening(lane, chunk))*chunks%volume(lane, chunk)
         state%ft(lane, plane, chunk) = rock%tensile_strength
      end do
      if (reset == normal_reset) return
      state%crack(lane, :, chunk) = 0.0_wp
      state%plastic_strain(lane, chunk) = 0.0_wp
      state%sin_phi(lane, chunk) = rock%sin_phi0
      state%c_cos_phi(lane, chunk) = rock%c_cos_phi0
   end subroutine reset_element

end module lithofrac_fracture_element_failure
