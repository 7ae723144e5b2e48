!> Central differences at the nodes (eqs 1, 3, 4): new velocity, new position, sums on the way.
!>
!> One run of nodes at a time; its sums are added in order of runs, so they do not depend on the
!> number of threads. A prescribed component has zero inverse mass and keeps its velocity.
module lithofrac_run_node_update
   use lithofrac_base_kinds, only: wp
   use lithofrac_base_sums, only: ordered_sums
   use lithofrac_mechanics_fields, only: fields_type
   use lithofrac_run_damping, only: affine_type, n_moments
   implicit none
   private

   public :: kinetic_of, move, n_sums, sum_moments, update_affine, update_ground, update_plain

   integer, parameter :: n_sums = 3  !! kinetic energy [J], damping power before and after [W]
   integer, parameter :: group = 128  !! nodes whose moments are summed together, near the core

contains

   !> No damping. A step that goes on with `drift` books no kinetic energy: nobody looks at it.
   pure subroutine update_plain(fields, first, last, dt, drift, sums)
      type(fields_type), intent(inout) :: fields
      integer, intent(in) :: first        !! first node of the run
      integer, intent(in) :: last         !! last node of the run
      real(wp), intent(in) :: dt          !! [s]
      logical, intent(in) :: drift        !! move the nodes as well
      real(wp), intent(out) :: sums(n_sums)

      sums = 0.0_wp
      associate (n => last - first + 1, v => fields%v, f => fields%internal, p => fields%external)
         if (drift) then
            call kick_and_drift(2*n, dt, fields%inverse_mass(1, first), p(1, first), f(1, first), &
               v(1, first), fields%u(1, first))
         else
            call kick(n, dt, fields%mass(first), fields%inverse_mass(1, first), p(1, first), &
               f(1, first), v(1, first), sums(1))
         end if
      end associate
   end subroutine update_plain

   !> Velocities of consecutive nodes, and their kinetic energy.
   pure subroutine kick(n, dt, mass, inverse_mass, external, internal, v, kinetic)
      integer, intent(in) :: n
      real(wp), intent(in) :: dt                  !! [s]
      real(wp), intent(in) :: mass(n)             !! [kg]
      real(wp), intent(in) :: inverse_mass(2, n)  !! [1/kg]
      real(wp), intent(in) :: external(2, n)      !! [N]
      real(wp), intent(in) :: internal(2, n)      !! [N]
      real(wp), intent(inout) :: v(2, n)          !! [m/s]
      real(wp), intent(out) :: kinetic            !! [J]

      real(wp) :: before(2), after(2), terms(n)
      integer :: i

      !$omp simd private(before, after)
      do i = 1, n
         before(1) = v(1, i)
         before(2) = v(2, i)
         after(1) = before(1) + inverse_mass(1, i)*(dt*(external(1, i) - internal(1, i)))
         after(2) = before(2) + inverse_mass(2, i)*(dt*(external(2, i) - internal(2, i)))
         v(1, i) = after(1)
         v(2, i) = after(2)
         terms(i) = 0.5_wp*mass(i)*(before(1)*after(1) + before(2)*after(2))
      end do
      kinetic = sum(ordered_sums(n, 1, terms))
   end subroutine kick

   !> Velocities, then displacements, of both components of consecutive nodes.
   pure subroutine kick_and_drift(n, dt, inverse_mass, external, internal, v, u)
      integer, intent(in) :: n
      real(wp), intent(in) :: dt               !! [s]
      real(wp), intent(in) :: inverse_mass(n)  !! [1/kg]
      real(wp), intent(in) :: external(n)      !! [N]
      real(wp), intent(in) :: internal(n)      !! [N]
      real(wp), intent(inout) :: v(n)          !! [m/s]
      real(wp), intent(inout) :: u(n)          !! [m]

      integer :: i

      !$omp simd
      do i = 1, n
         v(i) = v(i) + inverse_mass(i)*(dt*(external(i) - internal(i)))
         u(i) = u(i) + dt*v(i)
      end do
   end subroutine kick_and_drift

   !> Eq. 3: C = alpha M, centred in time.
   pure subroutine update_ground(fields, first, last, dt, drift, alpha, sums)
      type(fields_type), intent(inout) :: fields
      integer, intent(in) :: first
      integer, intent(in) :: last
      real(wp), intent(in) :: dt
      logical, intent(in) :: drift
      real(wp), intent(in) :: alpha       !! [1/s]
      real(wp), intent(out) :: sums(n_sums)

      associate (n => last - first + 1)
         call kick_ground(n, dt, alpha, fields%mass(first), fields%inverse_mass(1, first), &
            fields%free_mass(1, first), fields%external(1, first), fields%internal(1, first), &
            fields%v(1, first), sums)
         if (drift) call move(n, dt, fields%v(1, first), fields%u(1, first))
      end associate
   end subroutine update_ground

   !> Velocities of consecutive nodes, with what they book.
   pure subroutine kick_ground(n, dt, alpha, mass, inverse_mass, free_mass, external, internal, &
      v, sums)
      integer, intent(in) :: n
      real(wp), intent(in) :: dt                  !! [s]
      real(wp), intent(in) :: alpha               !! [1/s]
      real(wp), intent(in) :: mass(n)             !! [kg]
      real(wp), intent(in) :: inverse_mass(2, n)  !! [1/kg]
      real(wp), intent(in) :: free_mass(2, n)     !! [kg]
      real(wp), intent(in) :: external(2, n)      !! [N]
      real(wp), intent(in) :: internal(2, n)      !! [N]
      real(wp), intent(inout) :: v(2, n)          !! [m/s]
      real(wp), intent(out) :: sums(n_sums)

      real(wp) :: before, after, drag, terms(2, n, n_sums)
      integer :: i, k

      !$omp simd private(before, after, drag, k)
      do i = 1, n
         do k = 1, 2
            before = v(k, i)
            after = before + inverse_mass(k, i)*(dt*(external(k, i) - internal(k, i)) &
               - alpha*dt*free_mass(k, i)*before)/(1.0_wp + 0.5_wp*alpha*dt)
            drag = -0.5_wp*alpha*free_mass(k, i)*(before + after)
            v(k, i) = after
            terms(k, i, 1) = 0.5_wp*mass(i)*(before*after)
            terms(k, i, 2) = drag*before
            terms(k, i, 3) = drag*after
         end do
      end do
      sums = ordered_sums(2*n, n_sums, terms)
   end subroutine kick_ground

   !> Relative to the affine motion `fit`; also sums the moments for the next fit.
   !>
   !> The drag takes the velocity of the half step before, so that its net force and moment
   !> vanish exactly; this lowers the stable step by alpha dt/4, far inside the safety factor.
   pure subroutine update_affine(fields, nodes, first, last, dt, drift, alpha, fit, sums, moments)
      type(fields_type), intent(inout) :: fields
      integer, intent(in) :: first
      integer, intent(in) :: last
      real(wp), intent(in) :: nodes(2, last)  !! reference positions [m]
      real(wp), intent(in) :: dt
      logical, intent(in) :: drift
      real(wp), intent(in) :: alpha        !! [1/s]
      type(affine_type), intent(in) :: fit
      real(wp), intent(out) :: sums(n_sums)
      real(wp), intent(out) :: moments(n_moments)  !! see `fit_affine`

      call kick_affine(last - first + 1, dt, alpha, fit, nodes(1, first), fields%u(1, first), &
         fields%mass(first), fields%inverse_mass(1, first), fields%drag_mass(1, first), &
         fields%external(1, first), fields%internal(1, first), fields%v(1, first), sums)
      moments = sum_moments(fields, nodes, first, last, dt, fit%centre)
      if (drift) call move(last - first + 1, dt, fields%v(1, first), fields%u(1, first))
   end subroutine update_affine

   !> Velocities of consecutive nodes, with what they book.
   pure subroutine kick_affine(n, dt, alpha, fit, nodes, u, mass, inverse_mass, drag_mass, &
      external, internal, v, sums)
      integer, intent(in) :: n
      real(wp), intent(in) :: dt                  !! [s]
      real(wp), intent(in) :: alpha               !! [1/s]
      type(affine_type), intent(in) :: fit
      real(wp), intent(in) :: nodes(2, n)         !! reference positions [m]
      real(wp), intent(in) :: u(2, n)             !! [m]
      real(wp), intent(in) :: mass(n)             !! [kg]
      real(wp), intent(in) :: inverse_mass(2, n)  !! [1/kg]
      real(wp), intent(in) :: drag_mass(2, n)     !! [kg]
      real(wp), intent(in) :: external(2, n)      !! [N]
      real(wp), intent(in) :: internal(2, n)      !! [N]
      real(wp), intent(inout) :: v(2, n)          !! [m/s]
      real(wp), intent(out) :: sums(n_sums)

      real(wp) :: arm(2), before(2), after(2), drag(2), terms(n, n_sums)
      integer :: i

      !$omp simd private(arm, before, after, drag)
      do i = 1, n
         arm(1) = nodes(1, i) + u(1, i) - fit%centre(1)
         arm(2) = nodes(2, i) + u(2, i) - fit%centre(2)
         before(1) = v(1, i)
         before(2) = v(2, i)
         drag(1) = -alpha*drag_mass(1, i)*(before(1) - fit%velocity(1) &
            - fit%gradient(1, 1)*arm(1) - fit%gradient(1, 2)*arm(2))
         drag(2) = -alpha*drag_mass(2, i)*(before(2) - fit%velocity(2) &
            - fit%gradient(2, 1)*arm(1) - fit%gradient(2, 2)*arm(2))
         after(1) = before(1) + inverse_mass(1, i)*(dt*(external(1, i) - internal(1, i) + drag(1)))
         after(2) = before(2) + inverse_mass(2, i)*(dt*(external(2, i) - internal(2, i) + drag(2)))
         v(1, i) = after(1)
         v(2, i) = after(2)
         terms(i, 1) = 0.5_wp*mass(i)*(before(1)*after(1) + before(2)*after(2))
         terms(i, 2) = drag(1)*before(1) + drag(2)*before(2)
         terms(i, 3) = drag(1)*after(1) + drag(2)*after(2)
      end do
      sums = ordered_sums(n, n_sums, terms)
   end subroutine kick_affine

   !> Move consecutive nodes with their velocities.
   pure subroutine move(n, dt, v, u)
      integer, intent(in) :: n
      real(wp), intent(in) :: dt            !! [s]
      real(wp), intent(in) :: v(2, n)       !! [m/s]
      real(wp), intent(inout) :: u(2, n)    !! [m]

      u = u + dt*v
   end subroutine move

   !> Moments of a run of nodes about a point, at the positions that its velocities lead to.
   pure function sum_moments(fields, nodes, first, last, dt, about) result(moments)
      type(fields_type), intent(in) :: fields
      integer, intent(in) :: first
      integer, intent(in) :: last
      real(wp), intent(in) :: nodes(2, last)  !! reference positions [m]
      real(wp), intent(in) :: dt
      real(wp), intent(in) :: about(2)        !! [m], see `fit_affine`
      real(wp) :: moments(n_moments)

      integer :: from, n

      moments = 0.0_wp
      do from = first, last, group
         n = min(group, last - from + 1)
         moments = moments + moments_of(n, dt, about, fields%fit_mass(from), nodes(1, from), &
            fields%u(1, from), fields%v(1, from))
      end do
   end function sum_moments

   pure function moments_of(n, dt, about, mass, nodes, u, v) result(moments)
      integer, intent(in) :: n
      real(wp), intent(in) :: dt           !! [s]
      real(wp), intent(in) :: about(2)     !! [m]
      real(wp), intent(in) :: mass(n)      !! [kg]
      real(wp), intent(in) :: nodes(2, n)  !! reference positions [m]
      real(wp), intent(in) :: u(2, n)      !! [m]
      real(wp), intent(in) :: v(2, n)      !! [m/s]
      real(wp) :: moments(n_moments)

      real(wp) :: m, x, y, vx, vy, terms(n, n_moments)
      integer :: i

      !$omp simd private(m, x, y, vx, vy)
      do i = 1, n
         m = mass(i)
         vx = v(1, i)
         vy = v(2, i)
         x = nodes(1, i) + (u(1, i) + dt*vx) - about(1)
         y = nodes(2, i) + (u(2, i) + dt*vy) - about(2)
         terms(i, 1) = m
         terms(i, 2) = m*vx
         terms(i, 3) = m*vy
         terms(i, 4) = m*x
         terms(i, 5) = m*y
         terms(i, 6) = m*vx*x
         terms(i, 7) = m*vx*y
         terms(i, 8) = m*vy*x
         terms(i, 9) = m*vy*y
         terms(i, 10) = m*x*x
         terms(i, 11) = m*x*y
         terms(i, 12) = m*y*y
      end do
      moments = ordered_sums(n, n_moments, terms)
   end function moments_of

   !> Kinetic energy of consecutive nodes [J].
   pure function kinetic_of(n, mass, v) result(energy)
      integer, intent(in) :: n
      real(wp), intent(in) :: mass(n)  !! [kg]
      real(wp), intent(in) :: v(2, n)  !! [m/s]
      real(wp) :: energy

      real(wp) :: terms(n)
      integer :: i

      !$omp simd
      do i = 1, n
         terms(i) = 0.5_wp*mass(i)*(v(1, i)*v(1, i) + v(2, i)*v(2, i))
      end do
      energy = sum(ordered_sums(n, 1, terms))
   end function kinetic_of

end module lithofrac_run_node_update
