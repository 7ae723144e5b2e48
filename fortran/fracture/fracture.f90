!> What a run that cracks remembers: rules, topology, bonds, and a record of every crack.
module lithofrac_fracture_fracture
   use lithofrac_base_kinds, only: wp
   use lithofrac_base_status, only: bad_input, set_failure, status_type
   use lithofrac_fracture_arms, only: inter_element, intra_element
   use lithofrac_fracture_bonds, only: bonds_type
   use lithofrac_fracture_element_failure, only: normal_reset, paper_reset
   use lithofrac_fracture_failure_map, only: by_failure_factor, by_volume
   use lithofrac_fracture_fragment_drag, only: fragment_drag_type
   use lithofrac_fracture_plan, only: rules_type
   use lithofrac_mesh_mesh, only: mesh_type
   use lithofrac_mesh_topology, only: new_topology, topology_type
   implicit none
   private

   public :: fracture_type, new_fracture, record_crack
   public :: n_record

   integer, parameter :: n_record = 16  !! rows of `record`

   type :: fracture_type
      logical :: on = .false.
      type(rules_type) :: rules
      integer :: release_steps = -1                 !! of the traction on a crack; -1: by its length
      integer :: reset = normal_reset
      integer :: interval = 1                       !! steps between two failure maps
      type(topology_type) :: topology
      type(bonds_type) :: bonds
      type(fragment_drag_type) :: drag
      integer, allocatable :: heir(:)               !! (n_elements) itself, or a piece of it
      integer, allocatable :: resets(:)             !! (n_elements) times that it was reset
      !> (n_nodes) F_p below which it is left alone; positive where a crack had no way once
      real(wp), allocatable :: retry(:)
      real(wp) :: looked_at = 0.0_wp                !! `any_failed` of the last map
      integer :: n_waiting = 0                      !! failed nodes that the last map put off
      integer :: n_cracks = 0                       !! failed nodes that have cracked
      integer :: n_fallbacks = 0                    !! edges taken where a cut was planned
      integer :: n_edges = 0                        !! edges opened
      !> (n_record, >= n_edges) step; crack; ends x1, y1, x2, y2 [m]; length [m]; direction [rad];
      !> F_p; agreement; share of compressive dissipation; far end is split; goes through an
      !> element; is a fallback; release [steps]; body
      real(wp), allocatable :: record(:, :)
   end type fracture_type

contains

   !> Let the bodies of a mesh crack.
   subroutine new_fracture(fracture, mesh, poisson, mode, weights, release_steps, reset, &
         interval, least_factor, status)
      type(fracture_type), intent(out) :: fracture
      type(mesh_type), intent(in) :: mesh
      real(wp), intent(in) :: poisson(:)          !! (n_bodies)
      integer, intent(in) :: mode
      integer, intent(in) :: weights
      integer, intent(in) :: release_steps
      integer, intent(in) :: reset
      integer, intent(in) :: interval
      real(wp), intent(in) :: least_factor        !! F_p from which a node cracks
      type(status_type), intent(out) :: status

      integer :: i

      if (all(mode /= [inter_element, intra_element]) &
         .or. all(weights /= [by_volume, by_failure_factor]) &
         .or. all(reset /= [normal_reset, paper_reset])) then
         call set_failure(status, bad_input, "fracture: no such mode, weights or reset")
      else if (release_steps < -1 .or. interval < 1) then
         call set_failure(status, bad_input, "fracture: needs release >= 0 and interval >= 1 steps")
      else if (.not. least_factor >= 1.0_wp) then
         call set_failure(status, bad_input, "fracture: least_factor must be at least 1")
      else
         call new_topology(fracture%topology, mesh, status)
      end if
      fracture%rules%mode = mode
      fracture%rules%weights = weights
      fracture%rules%least_factor = least_factor
      fracture%rules%guard%poisson = poisson
      fracture%release_steps = release_steps
      fracture%reset = reset
      fracture%interval = interval
      fracture%heir = [(i, i=1, mesh%n_elements)]
      allocate (fracture%resets(mesh%n_elements), source=0)
      allocate (fracture%retry(mesh%n_nodes), source=0.0_wp)
      allocate (fracture%bonds%list(0), fracture%record(n_record, 0))
      allocate (fracture%drag%node(0), fracture%drag%first(1), fracture%drag%force(2, 0))
      fracture%drag%first = 1
      fracture%on = .true.
   end subroutine new_fracture

   !> Add a row to the record of opened edges.
   pure subroutine record_crack(fracture, row)
      type(fracture_type), intent(inout) :: fracture
      real(wp), intent(in) :: row(n_record)

      real(wp), allocatable :: longer(:, :)

      if (fracture%n_edges == size(fracture%record, 2)) then
         allocate (longer(n_record, max(64, 2*fracture%n_edges)), source=0.0_wp)
         longer(:, :fracture%n_edges) = fracture%record(:, :fracture%n_edges)
         call move_alloc(longer, fracture%record)
      end if
      fracture%n_edges = fracture%n_edges + 1
      fracture%record(:, fracture%n_edges) = row
   end subroutine record_crack

end module lithofrac_fracture_fracture
