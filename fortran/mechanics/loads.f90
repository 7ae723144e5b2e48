!> What acts on the boundary: prescribed velocities and follower pressure, with smooth ramps.
!>
!> Work is booked with half-step attribution: a force of time n acts over half of the step
!> before and half of the step after it, which closes the ledger of central differences.
module lithofrac_mechanics_loads
   use lithofrac_base_kinds, only: wp
   use lithofrac_mechanics_fields, only: fields_type
   implicit none
   private

   public :: pressure_type, ramp_type, ramp_value, velocity_type
   public :: add_forces, apply_pressure, apply_velocity, measure_edges, prescribed_kinetic
   public :: pressure_record, velocity_record, work_after, work_before

   !> Smooth rise from 0 to 1 over `duration` after `start`.
   type :: ramp_type
      real(wp) :: start = 0.0_wp      !! [s]
      real(wp) :: duration = 0.0_wp   !! [s], 0 is a jump
   end type ramp_type

   !> One velocity component of a set of nodes.
   type :: velocity_type
      integer, allocatable :: node(:)
      integer :: component = 1                   !! 1 or 2
      real(wp) :: speed = 0.0_wp                 !! [m/s]
      type(ramp_type) :: ramp
      real(wp), allocatable :: before(:)         !! velocity before the half step [m/s]
      real(wp) :: now = 0.0_wp                   !! velocity after it [m/s]
   end type velocity_type

   !> Follower pressure on edges, with an optional spring on the outward displacement.
   type :: pressure_type
      integer, allocatable :: edge(:, :)         !! (2, n_edges) nodes, material on the left
      integer, allocatable :: held(:, :)         !! (2, n_edges) element, side; if the mesh cracks
      real(wp) :: pressure = 0.0_wp              !! [Pa]
      real(wp) :: stiffness = 0.0_wp             !! [Pa/m]
      type(ramp_type) :: ramp
      real(wp), allocatable :: normal(:, :)      !! (2, n_edges) outward, reference
      real(wp), allocatable :: length(:)         !! (n_edges) reference weight [m], [m2/rad]
      real(wp), allocatable :: force(:, :, :)    !! (2, 2, n_edges) on the two nodes [N]
      real(wp) :: power_before = 0.0_wp          !! force times velocity before the half step [W]
   end type pressure_type

contains

   !> 6 s^5 - 15 s^4 + 10 s^3: value, slope and curvature start and end at rest.
   pure function ramp_value(ramp, time) result(value)
      type(ramp_type), intent(in) :: ramp
      real(wp), intent(in) :: time   !! [s]
      real(wp) :: value

      real(wp) :: s

      if (time < ramp%start) then
         value = 0.0_wp
      else if (time >= ramp%start + ramp%duration) then
         value = 1.0_wp
      else
         s = (time - ramp%start)/ramp%duration
         value = s*s*s*(10.0_wp + s*(6.0_wp*s - 15.0_wp))
      end if
   end function ramp_value

   !> Outward normals and reference weights of the edges.
   subroutine measure_edges(load, nodes, axisymmetric)
      type(pressure_type), intent(inout) :: load
      real(wp), intent(in) :: nodes(:, :)          !! (2, n_nodes) reference positions [m]
      logical, intent(in) :: axisymmetric

      real(wp) :: along(2)
      integer :: i, n

      n = size(load%edge, 2)
      load%normal = spread([0.0_wp, 0.0_wp], 2, n)
      load%length = spread(0.0_wp, 1, n)
      do i = 1, n
         along = nodes(:, load%edge(2, i)) - nodes(:, load%edge(1, i))
         load%length(i) = norm2(along)
         load%normal(:, i) = [along(2), -along(1)]/load%length(i)
         if (axisymmetric) load%length(i) = load%length(i)*0.5_wp*sum(nodes(1, load%edge(:, i)))
      end do
   end subroutine measure_edges

   !> Forces of the pressure at `time`, on the positions of now.
   subroutine apply_pressure(load, nodes, axisymmetric, time, fields)
      type(pressure_type), intent(inout) :: load
      real(wp), intent(in) :: nodes(:, :)          !! (2, n_nodes) reference positions [m]
      logical, intent(in) :: axisymmetric
      real(wp), intent(in) :: time                 !! [s]
      type(fields_type), intent(inout) :: fields   !! `external` is added to

      real(wp) :: x(2, 2), thrust(2), weight(2)
      integer :: i

      load%power_before = 0.0_wp
      do i = 1, size(load%edge, 2)
         associate (node => load%edge(:, i))
            x = nodes(:, node) + fields%u(:, node)
            thrust = -local_pressure(load, i, time, fields)*[x(2, 2) - x(2, 1), x(1, 1) - x(1, 2)]
            weight = 0.5_wp
            if (axisymmetric) weight = (x(1, :) + sum(x(1, :)))/6.0_wp
            load%force(:, 1, i) = weight(1)*thrust
            load%force(:, 2, i) = weight(2)*thrust
            fields%external(:, node) = fields%external(:, node) + load%force(:, :, i)
            load%power_before = load%power_before + sum(load%force(:, :, i)*fields%v(:, node))
         end associate
      end do
   end subroutine apply_pressure

   !> Forces that the pressure has at this step, added to those on the nodes.
   subroutine add_forces(load, fields)
      type(pressure_type), intent(in) :: load
      type(fields_type), intent(inout) :: fields

      integer :: i

      do i = 1, size(load%edge, 2)
         fields%external(:, load%edge(:, i)) = fields%external(:, load%edge(:, i)) &
            + load%force(:, :, i)
      end do
   end subroutine add_forces

   pure function local_pressure(load, i, time, fields) result(pressure)
      type(pressure_type), intent(in) :: load
      integer, intent(in) :: i
      real(wp), intent(in) :: time
      type(fields_type), intent(in) :: fields
      real(wp) :: pressure

      pressure = load%pressure*ramp_value(load%ramp, time) &
         + load%stiffness*outward(load, i, fields)
   end function local_pressure

   !> Outward displacement of the middle of an edge [m].
   pure function outward(load, i, fields) result(displacement)
      type(pressure_type), intent(in) :: load
      integer, intent(in) :: i
      type(fields_type), intent(in) :: fields
      real(wp) :: displacement

      displacement = 0.5_wp*dot_product(load%normal(:, i), &
         fields%u(:, load%edge(1, i)) + fields%u(:, load%edge(2, i)))
   end function outward

   !> Overwrite the prescribed component with its value at the half step after `time`.
   subroutine apply_velocity(load, time_half, fields)
      type(velocity_type), intent(inout) :: load
      real(wp), intent(in) :: time_half            !! [s]
      type(fields_type), intent(inout) :: fields

      load%before = fields%v(load%component, load%node)
      load%now = load%speed*ramp_value(load%ramp, time_half)
      fields%v(load%component, load%node) = load%now
   end subroutine apply_velocity

   !> Reaction on node `i` of the set [N]: what made it move as prescribed.
   pure function reaction(load, i, dt, fields) result(force)
      type(velocity_type), intent(in) :: load
      integer, intent(in) :: i
      real(wp), intent(in) :: dt
      type(fields_type), intent(in) :: fields
      real(wp) :: force

      associate (node => load%node(i), k => load%component)
         force = fields%mass(node)*(load%now - load%before(i))/dt + fields%internal(k, node) &
            - fields%external(k, node) - fields%contact(k, node)
      end associate
   end function reaction

   !> What the kinetic energy of the nodes lacks where a velocity was overwritten [J].
   !>
   !> The nodes sum 1/2 m v(n-1/2) v(n+1/2); at a prescribed component they see v(n+1/2) twice.
   pure function prescribed_kinetic(velocities, fields) result(energy)
      type(velocity_type), intent(in) :: velocities(:)
      type(fields_type), intent(in) :: fields
      real(wp) :: energy

      integer :: load

      energy = 0.0_wp
      do load = 1, size(velocities)
         associate (set => velocities(load))
            energy = energy + 0.5_wp*set%now*sum(fields%mass(set%node)*(set%before - set%now))
         end associate
      end do
   end function prescribed_kinetic

   !> Half-step work of all loads before time n [J].
   pure function work_before(velocities, pressures, dt, fields) result(work)
      type(velocity_type), intent(in) :: velocities(:)
      type(pressure_type), intent(in) :: pressures(:)
      real(wp), intent(in) :: dt
      type(fields_type), intent(in) :: fields
      real(wp) :: work

      integer :: load, i

      work = 0.0_wp
      do load = 1, size(pressures)
         work = work + 0.5_wp*dt*pressures(load)%power_before
      end do
      do load = 1, size(velocities)
         do i = 1, size(velocities(load)%node)
            work = work + 0.5_wp*dt*reaction(velocities(load), i, dt, fields) &
               *velocities(load)%before(i)
         end do
      end do
   end function work_before

   !> Half-step work of all loads after time n [J].
   pure function work_after(velocities, pressures, dt, fields) result(work)
      type(velocity_type), intent(in) :: velocities(:)
      type(pressure_type), intent(in) :: pressures(:)
      real(wp), intent(in) :: dt
      type(fields_type), intent(in) :: fields
      real(wp) :: work

      integer :: load, i

      work = 0.0_wp
      do load = 1, size(pressures)
         do i = 1, size(pressures(load)%edge, 2)
            work = work + 0.5_wp*dt*sum(pressures(load)%force(:, :, i) &
               *fields%v(:, pressures(load)%edge(:, i)))
         end do
      end do
      do load = 1, size(velocities)
         do i = 1, size(velocities(load)%node)
            work = work + 0.5_wp*dt*reaction(velocities(load), i, dt, fields)*velocities(load)%now
         end do
      end do
   end function work_after

   !> Sum of the reactions [N] and mean displacement [m] of a prescribed component.
   pure subroutine velocity_record(load, dt, fields, force, displacement)
      type(velocity_type), intent(in) :: load
      real(wp), intent(in) :: dt
      type(fields_type), intent(in) :: fields
      real(wp), intent(out) :: force
      real(wp), intent(out) :: displacement

      integer :: i

      force = 0.0_wp
      do i = 1, size(load%node)
         force = force + reaction(load, i, dt, fields)
      end do
      displacement = sum(fields%u(load%component, load%node))/size(load%node)
   end subroutine velocity_record

   !> Pressure times area [N] and mean outward displacement [m] of a loaded face.
   pure subroutine pressure_record(load, time, fields, force, displacement)
      type(pressure_type), intent(in) :: load
      real(wp), intent(in) :: time
      type(fields_type), intent(in) :: fields
      real(wp), intent(out) :: force
      real(wp), intent(out) :: displacement

      integer :: i

      force = 0.0_wp
      displacement = 0.0_wp
      do i = 1, size(load%edge, 2)
         force = force + load%length(i)*local_pressure(load, i, time, fields)
         displacement = displacement + load%length(i)*outward(load, i, fields)
      end do
      displacement = displacement/sum(load%length)
   end subroutine pressure_record

end module lithofrac_mechanics_loads
