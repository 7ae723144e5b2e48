!> Traction that still bridges a new crack, and how it fades.
!>
!> A crack is inserted where strength is used up on average, so some traction is left. To drop
!> it at once (the paper's way) is a blow that the material never gets. When a node splits,
!> forces on its copies keep their accelerations equal: the split itself changes nothing. They
!> then fade smoothly. They add up to zero and do work only as the crack opens or slips.
module lithofrac_fracture_bonds
   use lithofrac_base_kinds, only: wp
   implicit none
   private

   public :: add_bond, apply_bonds, bond_power, bond_type, bonds_type, forget_bonds

   !> The pull on one node.
   type :: bond_type
      integer :: node = 0
      integer :: begin = 0                     !! step at which it is whole
      integer :: length = 1                    !! steps until it is gone
      real(wp) :: whole(2) = 0.0_wp            !! [N]
      real(wp) :: force(2) = 0.0_wp            !! at this step [N]
   end type bond_type

   type :: bonds_type
      type(bond_type), allocatable :: list(:)
      real(wp) :: power_before = 0.0_wp        !! with the velocity before the half step [W]
   end type bonds_type

contains

   pure subroutine add_bond(bonds, bond)
      type(bonds_type), intent(inout) :: bonds
      type(bond_type), intent(in) :: bond

      bonds%list = [bonds%list, bond]
   end subroutine add_bond

   !> Forces of this step, added to those on the nodes; and their power.
   pure subroutine apply_bonds(bonds, step, v, external)
      type(bonds_type), intent(inout) :: bonds
      integer, intent(in) :: step
      real(wp), intent(in) :: v(:, :)             !! (2, n_nodes) before the half step [m/s]
      real(wp), intent(inout) :: external(:, :)   !! (2, n_nodes) [N]

      integer :: i

      do i = 1, size(bonds%list)
         associate (bond => bonds%list(i))
            bond%force = remaining(real(step - bond%begin, wp)/bond%length)*bond%whole
            external(:, bond%node) = external(:, bond%node) + bond%force
         end associate
      end do
      bonds%power_before = bond_power(bonds, v)
   end subroutine apply_bonds

   !> Power of the bonds of this step [W].
   pure function bond_power(bonds, v) result(power)
      type(bonds_type), intent(in) :: bonds
      real(wp), intent(in) :: v(:, :)          !! (2, n_nodes) [m/s]
      real(wp) :: power

      integer :: i

      power = 0.0_wp
      do i = 1, size(bonds%list)
         power = power + dot_product(bonds%list(i)%force, v(:, bonds%list(i)%node))
      end do
   end function bond_power

   !> Let go of what has faded by this step.
   pure subroutine forget_bonds(bonds, step)
      type(bonds_type), intent(inout) :: bonds
      integer, intent(in) :: step

      bonds%list = pack(bonds%list, step - bonds%list%begin < bonds%list%length)
   end subroutine forget_bonds

   !> Smooth fall from 1 to 0 while s goes from 0 to 1.
   pure function remaining(s) result(share)
      real(wp), intent(in) :: s
      real(wp) :: share

      share = 0.0_wp
      if (s < 1.0_wp) share = 1.0_wp - s*s*s*(10.0_wp + s*(6.0_wp*s - 15.0_wp))
   end function remaining

end module lithofrac_fracture_bonds
