!> The energy ledger: two sides, accumulated independently.
!>
!> Inside: elastic energy of the elements and what they dissipated. Outside: work of the
!> boundary, of contact, of fading bonds and of damping at the nodes, and the kinetic energy of the
!> leap-frog. Their difference is the residual; nothing is defined as the missing term. What the
!> leap-frog itself gains or loses as elements turn is known in closed form and has its own entry.
module lithofrac_run_energy
   use lithofrac_base_kinds, only: wp
   implicit none
   private

   public :: ledger_type, n_ledger, pack_ledger, residual

   integer, parameter :: n_ledger = 14  !! entries of `pack_ledger`

   type :: ledger_type
      real(wp) :: initial = 0.0_wp      !! kinetic and elastic at the start [J]
      real(wp) :: kinetic = 0.0_wp      !! 1/2 v(n-1/2) M v(n+1/2) [J]
      real(wp) :: elastic = 0.0_wp      !! [J]
      real(wp) :: compressive = 0.0_wp  !! dissipated by the Mohr-Coulomb planes [J]
      real(wp) :: fracture = 0.0_wp     !! dissipated by the tension planes [J]
      real(wp) :: external = 0.0_wp     !! work of the boundary [J]
      real(wp) :: damping = 0.0_wp      !! work of damping, negative when it takes energy [J]
      real(wp) :: contact = 0.0_wp      !! work of contact pressure [J], <= 0 where it is exact
      real(wp) :: friction = 0.0_wp     !! work of friction, negative when it takes energy [J]
      real(wp) :: insertion = 0.0_wp    !! work of fading bonds, negative when they take energy [J]
      real(wp) :: relump = 0.0_wp       !! kinetic energy lost as mass went to new nodes [J], <= 0
      real(wp) :: turning = 0.0_wp      !! given by elements that turn along chords [J]
      real(wp) :: reset = 0.0_wp        !! fracture energy to spend again; not in the balance [J]
      real(wp) :: scale = 0.0_wp        !! largest internal energy so far [J]
   end type ledger_type

contains

   !> Inside minus outside, relative to max(external work, initial, peak internal energy).
   pure function residual(ledger)
      type(ledger_type), intent(in) :: ledger
      real(wp) :: residual

      real(wp) :: scale

      scale = max(abs(ledger%external), abs(ledger%initial), ledger%scale)
      residual = ledger%kinetic + ledger%elastic + ledger%compressive + ledger%fracture &
         - ledger%initial - ledger%external - ledger%damping - ledger%contact - ledger%friction &
         - ledger%insertion - ledger%relump - ledger%turning
      if (scale > 0.0_wp) residual = residual/scale
   end function residual

   !> kinetic, elastic, compressive, fracture, external, damping, residual, initial, contact,
   !> friction, insertion, relump, reset, turning.
   pure function pack_ledger(ledger) result(values)
      type(ledger_type), intent(in) :: ledger
      real(wp) :: values(n_ledger)

      values = [ledger%kinetic, ledger%elastic, ledger%compressive, ledger%fracture, &
         ledger%external, ledger%damping, residual(ledger), ledger%initial, &
         ledger%contact, ledger%friction, ledger%insertion, ledger%relump, ledger%reset, &
         ledger%turning]
   end function pack_ledger

end module lithofrac_run_energy
