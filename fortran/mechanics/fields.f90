!> What changes during a run at nodes and in elements.
!>
!> Stress is not stored: it follows from displacement and inelastic strain, so a virgin element
!> costs no history at all.
module lithofrac_mechanics_fields
   use lithofrac_base_kinds, only: wp
   use lithofrac_material_rock, only: rock_type
   use lithofrac_material_stress_update, only: softening_modulus
   use lithofrac_mechanics_chunks, only: chunks_type, width
   implicit none
   private

   public :: fields_type, inelastic_type, move_inelastic, new_fields, new_inelastic
   public :: free_all, prescribe

   !> Nodal fields.
   type :: fields_type
      real(wp), allocatable :: u(:, :)             !! (2, n_nodes) displacement [m]
      real(wp), allocatable :: v(:, :)             !! (2, n_nodes) velocity at the half step [m/s]
      real(wp), allocatable :: internal(:, :)      !! (2, n_nodes) internal force [N]
      real(wp), allocatable :: external(:, :)      !! (2, n_nodes) pressure force [N]
      real(wp), allocatable :: contact(:, :)       !! (2, n_nodes) contact force [N]
      real(wp), allocatable :: mass(:)             !! (n_nodes) [kg]
      real(wp), allocatable :: inverse_mass(:, :)  !! (2, n_nodes) 0 where prescribed [1/kg]
      real(wp), allocatable :: free_mass(:, :)     !! (2, n_nodes) 0 where prescribed [kg]
      real(wp), allocatable :: drag_mass(:, :)     !! (2, n_nodes) 0 also on loose fragments [kg]
      real(wp), allocatable :: fit_mass(:)         !! (n_nodes) 0 on loose fragments [kg]
   end type fields_type

   !> State of the material in the elements; lane and chunk as in `chunks_type`.
   !> `dissipated` is by the Mohr-Coulomb planes (1) and by the tension planes (2).
   type :: inelastic_type
      logical, allocatable :: touched(:)           !! (n_chunks) some element has yielded
      real(wp), allocatable :: strain(:, :, :)     !! (width, 4, n_chunks) inelastic strain
      real(wp), allocatable :: plastic_strain(:, :) !! (width, n_chunks) effective, eq. 7
      real(wp), allocatable :: ft(:, :, :)         !! (width, 3, n_chunks) tensile strengths [Pa]
      real(wp), allocatable :: opening(:, :, :)    !! (width, 3, n_chunks) fracturing strains
      real(wp), allocatable :: axis(:, :, :)       !! (width, 2, n_chunks) cos 2a, sin 2a of axis 1
      real(wp), allocatable :: crack(:, :, :)      !! (width, 2, n_chunks) sums of eq. 13
      real(wp), allocatable :: sin_phi(:, :)       !! (width, n_chunks) mobilised friction
      real(wp), allocatable :: c_cos_phi(:, :)     !! (width, n_chunks) mobilised cohesion [Pa]
      real(wp), allocatable :: dissipated(:, :, :) !! (width, 2, n_chunks) see above [J/m3]
      real(wp), allocatable :: softening(:, :)     !! (width, n_chunks) H of eq. 16 [Pa], <= 0
   end type inelastic_type

contains

   !> Nodal fields at rest, without mass.
   subroutine new_fields(fields, n_nodes)
      type(fields_type), intent(out) :: fields
      integer, intent(in) :: n_nodes

      allocate (fields%u(2, n_nodes), fields%v(2, n_nodes), source=0.0_wp)
      allocate (fields%internal(2, n_nodes), fields%external(2, n_nodes), source=0.0_wp)
      allocate (fields%contact(2, n_nodes), source=0.0_wp)
      allocate (fields%mass(n_nodes), source=0.0_wp)
   end subroutine new_fields

   !> Masses that follow from the lumped ones while no component is prescribed.
   subroutine free_all(fields)
      type(fields_type), intent(inout) :: fields

      fields%free_mass = spread(fields%mass, 1, 2)
      fields%inverse_mass = 1.0_wp/fields%free_mass
      fields%drag_mass = fields%free_mass
      fields%fit_mass = fields%mass
   end subroutine free_all

   !> Prescribe a velocity component of some nodes.
   subroutine prescribe(fields, component, node)
      type(fields_type), intent(inout) :: fields
      integer, intent(in) :: component        !! 1 or 2
      integer, intent(in) :: node(:)

      fields%free_mass(component, node) = 0.0_wp
      fields%inverse_mass(component, node) = 0.0_wp
      fields%drag_mass(component, node) = 0.0_wp
   end subroutine prescribe

   !> Virgin material everywhere.
   subroutine new_inelastic(state, chunks, rocks, band_width)
      type(inelastic_type), intent(out) :: state
      type(chunks_type), intent(in) :: chunks
      type(rock_type), intent(in) :: rocks(:)       !! (n_bodies)
      real(wp), intent(in) :: band_width(:)         !! (n_elements) crack band width [m]

      integer :: chunk, lane

      associate (n => chunks%n_chunks)
         allocate (state%touched(n), source=.false.)
         allocate (state%strain(width, 4, n), state%opening(width, 3, n), source=0.0_wp)
         allocate (state%plastic_strain(width, n), state%softening(width, n), source=0.0_wp)
         allocate (state%crack(width, 2, n), state%dissipated(width, 2, n), source=0.0_wp)
         allocate (state%ft(width, 3, n), state%axis(width, 2, n))
         allocate (state%sin_phi(width, n), state%c_cos_phi(width, n))
      end associate
      do chunk = 1, chunks%n_chunks
         associate (rock => rocks(chunks%body(chunk)))
            state%ft(:, :, chunk) = rock%tensile_strength
            state%axis(:, 1, chunk) = 1.0_wp
            state%axis(:, 2, chunk) = 0.0_wp
            state%sin_phi(:, chunk) = rock%sin_phi0
            state%c_cos_phi(:, chunk) = rock%c_cos_phi0
            if (.not. rock%yields) cycle
            do lane = 1, chunks%filled(chunk)
               state%softening(lane, chunk) = &
                  softening_modulus(rock, band_width(chunks%element(lane, chunk)))
            end do
         end associate
      end do
   end subroutine new_inelastic

   !> State for a new layout of the elements; each has what `source` had in the old one.
   subroutine move_inelastic(old, old_chunks, source, chunks, state)
      type(inelastic_type), intent(in) :: old
      type(chunks_type), intent(in) :: old_chunks
      integer, intent(in) :: source(:)              !! (n_elements) an element of the old layout
      type(chunks_type), intent(in) :: chunks
      type(inelastic_type), intent(inout) :: state  !! virgin, of the new layout

      integer :: chunk, lane, from, from_lane

      do chunk = 1, chunks%n_chunks
         do lane = 1, chunks%filled(chunk)
            from = old_chunks%chunk_of(source(chunks%element(lane, chunk)))
            from_lane = old_chunks%lane_of(source(chunks%element(lane, chunk)))
            state%touched(chunk) = state%touched(chunk) .or. old%touched(from)
            state%strain(lane, :, chunk) = old%strain(from_lane, :, from)
            state%plastic_strain(lane, chunk) = old%plastic_strain(from_lane, from)
            state%ft(lane, :, chunk) = old%ft(from_lane, :, from)
            state%opening(lane, :, chunk) = old%opening(from_lane, :, from)
            state%axis(lane, :, chunk) = old%axis(from_lane, :, from)
            state%crack(lane, :, chunk) = old%crack(from_lane, :, from)
            state%sin_phi(lane, chunk) = old%sin_phi(from_lane, from)
            state%c_cos_phi(lane, chunk) = old%c_cos_phi(from_lane, from)
            state%dissipated(lane, :, chunk) = old%dissipated(from_lane, :, from)
            state%softening(lane, chunk) = old%softening(from_lane, from)
         end do
      end do
   end subroutine move_inelastic

end module lithofrac_mechanics_fields
