!> Central differences at the nodes (eqs 1, 3, 4): new velocity, new position, sums on the way.
!>
!> One run of nodes at a time; its sums are added in order of runs, so they do not depend on the
!> number of threads. A prescribed component has zero inverse mass and keeps its velocity.
module lithofrac_run_node_update
   use lithofrac_base_kinds, only: wp
   use lithofrac_mechanics_fields, only: fields_type
   use lithofrac_run_damping, only: affine_type, n_moments
   implicit none
   private

   public :: n_sums, sum_moments, update_affine, update_ground, update_plain

   integer, parameter :: n_sums = 3  !! kinetic energy [J], damping power before and after [W]

contains

   !> No damping. A step that goes on with `drift` books no kinetic energy: nobody looks at it.
   pure subroutine update_plain(fields, first, last, dt, drift, sums)
      type(fields_type), intent(inout) :: fields
      integer, intent(in) :: first        !! first node of the run
      integer, intent(in) :: last         !! last node of the run
      real(wp), intent(in) :: dt          !! [s]
      logical, intent(in) :: drift        !! move the nodes as well
      real(wp), intent(out) :: sums(n_sums)

      real(wp) :: before, after, kinetic
      integer :: node, k

      sums = 0.0_wp
      associate (v => fields%v, f => fields%internal, p => fields%external)
         if (drift) then
            call kick_and_drift(2*(last - first + 1), dt, fields%inverse_mass(1, first), &
               p(1, first), f(1, first), v(1, first), fields%u(1, first))
            return
         end if
         kinetic = 0.0_wp
         !$omp simd private(before, after, k) reduction(+:kinetic)
         do node = first, last
            do k = 1, 2
               before = v(k, node)
               after = before + fields%inverse_mass(k, node)*(dt*(p(k, node) - f(k, node)))
               v(k, node) = after
               kinetic = kinetic + 0.5_wp*fields%mass(node)*(before*after)
            end do
         end do
      end associate
      sums(1) = kinetic
   end subroutine update_plain

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

      real(wp) :: before, after, drag, kinetic, power_before, power_after
      integer :: node, k

      kinetic = 0.0_wp
      power_before = 0.0_wp
      power_after = 0.0_wp
      associate (u => fields%u, v => fields%v, f => fields%internal, p => fields%external)
         !$omp simd private(before, after, drag, k) reduction(+:kinetic, power_before, power_after)
         do node = first, last
            do k = 1, 2
               before = v(k, node)
               after = before + fields%inverse_mass(k, node)*(dt*(p(k, node) - f(k, node)) &
                  - alpha*dt*fields%free_mass(k, node)*before)/(1.0_wp + 0.5_wp*alpha*dt)
               drag = -0.5_wp*alpha*fields%free_mass(k, node)*(before + after)
               v(k, node) = after
               kinetic = kinetic + 0.5_wp*fields%mass(node)*(before*after)
               power_before = power_before + drag*before
               power_after = power_after + drag*after
            end do
         end do
         if (drift) u(:, first:last) = u(:, first:last) + dt*v(:, first:last)
      end associate
      sums = [kinetic, power_before, power_after]
   end subroutine update_ground

   !> Relative to the affine motion `fit`; also sums the moments for the next fit.
   !>
   !> The drag takes the velocity of the half step before, so that its net force and moment
   !> vanish exactly; this lowers the stable step by alpha dt/4, far inside the safety factor.
   pure subroutine update_affine(fields, nodes, first, last, dt, drift, alpha, fit, sums, moments)
      type(fields_type), intent(inout) :: fields
      real(wp), intent(in) :: nodes(:, :)  !! (2, n_nodes) reference positions [m]
      integer, intent(in) :: first
      integer, intent(in) :: last
      real(wp), intent(in) :: dt
      logical, intent(in) :: drift
      real(wp), intent(in) :: alpha        !! [1/s]
      type(affine_type), intent(in) :: fit
      real(wp), intent(out) :: sums(n_sums)
      real(wp), intent(out) :: moments(n_moments)  !! see `fit_affine`

      real(wp) :: arm(2), before(2), after(2), drag(2), kinetic, power_before, power_after
      integer :: node

      kinetic = 0.0_wp
      power_before = 0.0_wp
      power_after = 0.0_wp
      associate (u => fields%u, v => fields%v, f => fields%internal, p => fields%external, &
            inverse_mass => fields%inverse_mass, drag_mass => fields%drag_mass)
         !$omp simd private(arm, before, after, drag) &
         !$omp& reduction(+:kinetic, power_before, power_after)
         do node = first, last
            arm(1) = nodes(1, node) + u(1, node) - fit%centre(1)
            arm(2) = nodes(2, node) + u(2, node) - fit%centre(2)
            before(1) = v(1, node)
            before(2) = v(2, node)
            drag(1) = -alpha*drag_mass(1, node)*(before(1) - fit%velocity(1) &
               - fit%gradient(1, 1)*arm(1) - fit%gradient(1, 2)*arm(2))
            drag(2) = -alpha*drag_mass(2, node)*(before(2) - fit%velocity(2) &
               - fit%gradient(2, 1)*arm(1) - fit%gradient(2, 2)*arm(2))
            after(1) = before(1) + inverse_mass(1, node)*(dt*(p(1, node) - f(1, node) + drag(1)))
            after(2) = before(2) + inverse_mass(2, node)*(dt*(p(2, node) - f(2, node) + drag(2)))
            v(1, node) = after(1)
            v(2, node) = after(2)
            kinetic = kinetic &
               + 0.5_wp*fields%mass(node)*(before(1)*after(1) + before(2)*after(2))
            power_before = power_before + (drag(1)*before(1) + drag(2)*before(2))
            power_after = power_after + (drag(1)*after(1) + drag(2)*after(2))
         end do
         moments = sum_moments(fields, nodes, first, last, dt)
         if (drift) u(:, first:last) = u(:, first:last) + dt*v(:, first:last)
      end associate
      sums = [kinetic, power_before, power_after]
   end subroutine update_affine

   !> Moments of a run of nodes at the positions that its velocities lead to.
   pure function sum_moments(fields, nodes, first, last, dt) result(moments)
      type(fields_type), intent(in) :: fields
      real(wp), intent(in) :: nodes(:, :)
      integer, intent(in) :: first
      integer, intent(in) :: last
      real(wp), intent(in) :: dt
      real(wp) :: moments(n_moments)

      real(wp) :: m, x, y, vx, vy, s1, s2, s3, s4, s5, s6, s7, s8, s9, s10, s11, s12
      integer :: node

      s1 = 0.0_wp; s2 = 0.0_wp; s3 = 0.0_wp; s4 = 0.0_wp; s5 = 0.0_wp; s6 = 0.0_wp
      s7 = 0.0_wp; s8 = 0.0_wp; s9 = 0.0_wp; s10 = 0.0_wp; s11 = 0.0_wp; s12 = 0.0_wp
      !$omp simd private(m, x, y, vx, vy) &
      !$omp& reduction(+:s1, s2, s3, s4, s5, s6, s7, s8, s9, s10, s11, s12)
      do node = first, last
         m = fields%fit_mass(node)
         vx = fields%v(1, node)
         vy = fields%v(2, node)
         x = nodes(1, node) + (fields%u(1, node) + dt*vx)
         y = nodes(2, node) + (fields%u(2, node) + dt*vy)
         s1 = s1 + m
         s2 = s2 + m*vx
         s3 = s3 + m*vy
         s4 = s4 + m*x
         s5 = s5 + m*y
         s6 = s6 + m*vx*x
         s7 = s7 + m*vx*y
         s8 = s8 + m*vy*x
         s9 = s9 + m*vy*y
         s10 = s10 + m*x*x
         s11 = s11 + m*x*y
         s12 = s12 + m*y*y
      end do
      moments = [s1, s2, s3, s4, s5, s6, s7, s8, s9, s10, s11, s12]
   end function sum_moments

end module lithofrac_run_node_update
