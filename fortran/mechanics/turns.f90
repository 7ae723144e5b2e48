!> What central differences gain or lose as elements turn: nodes move along chords, elements on
!> arcs.
!>
!> It changes no force. The ledger has an entry for it, so that its two sides close to rounding
!> however fast the motion is.
module lithofrac_mechanics_turns
   use lithofrac_base_kinds, only: wp
   use lithofrac_base_sums, only: ordered_sums
   use lithofrac_material_rock, only: rock_type
   use lithofrac_mechanics_chunks, only: chunks_type, width
   use lithofrac_mechanics_fields, only: fields_type, inelastic_type
   use lithofrac_mechanics_kinematics, only: elastic_stress, gather, hoop_strain, strains
   implicit none
   private

   public :: chord_work, stretch_type, look

   !> Elements of a chunk at one end of a step.
   type :: stretch_type
      real(wp) :: strain(width, 4)    !! U - I, engineering shear
      real(wp) :: rotation(width, 3)  !! cos, sin, 1/tr U
      real(wp) :: stress(width, 4)    !! unrotated [Pa]
   end type stretch_type

contains

   !> Stretch, rotation and stress of a chunk at u - back v, with the inelastic strain of now.
   subroutine look(chunks, chunk, rock, fields, state, back, stretch)
      type(chunks_type), intent(in) :: chunks
      integer, intent(in) :: chunk
      type(rock_type), intent(in) :: rock
      type(fields_type), intent(in) :: fields
      type(inelastic_type), intent(in) :: state
      real(wp), intent(in) :: back                !! time before the positions of now [s]
      type(stretch_type), intent(out) :: stretch

      real(wp) :: du(width, 4), dv(width, 4), rate(width)

      associate (node => chunks%node(:, :, chunk), hoop => chunks%hoop(:, chunk), &
            strain => stretch%strain)
         call gather(node, size(fields%u, 2), fields%u, du)
         call gather(node, size(fields%v, 2), fields%v, dv)
         strain(:, 3) = 0.0_wp
         if (chunks%axisymmetric) then
            call hoop_strain(node, size(fields%u, 2), fields%u, hoop, strain(:, 3))
            call hoop_strain(node, size(fields%v, 2), fields%v, hoop, rate)
            strain(:, 3) = strain(:, 3) - back*rate
         end if
         du = du - back*dv
         call strains(width, chunks%gradient(:, :, chunk), du, strain, stretch%rotation)
         call elastic_stress(width, rock%lame, rock%shear, strain, state%strain(:, :, chunk), &
            stretch%stress)
      end associate
   end subroutine look

   !> Work that nodal forces do in a step beyond that of the mean stress on the strain [J].
   !>
   !> With F = R U before (0) and after (1), the angle a from R0 to R1 and forces from
   !> P = R (T - (b/tr U) J), b = T : (J U):
   !>
   !>    1/2 (P0 + P1) : (F1 - F0) - 1/2 (T0 + T1) : (U1 - U0)
   !>       = 1/2 sin a (T0 : JU1 + T1 : JU0 - b0 tr U1/tr U0 - b1 tr U0/tr U1)
   !>         - 1/2 (1 - cos a) (T0 : U1 - T1 : U0)
   !>
   !> Central differences have that much less energy after the step; it is of third order in it.
   pure function chord_work(volume, before, after) result(work)
      real(wp), intent(in) :: volume(width)       !! [m3] per metre or per radian
      type(stretch_type), intent(in) :: before
      type(stretch_type), intent(in) :: after
      real(wp) :: work

      work = chord_sum(width, volume, before%strain, before%rotation, before%stress, &
         after%strain, after%rotation, after%stress)
   end function chord_work

   pure function chord_sum(n, volume, strain0, rotation0, stress0, strain1, rotation1, stress1) &
      result(work)
      integer, intent(in) :: n                !! lanes
      real(wp), intent(in) :: volume(n)       !! [m3] per metre or per radian
      real(wp), intent(in) :: strain0(n, 4)   !! U - I, engineering shear
      real(wp), intent(in) :: rotation0(n, 3) !! cos, sin, 1/tr U
      real(wp), intent(in) :: stress0(n, 4)   !! unrotated [Pa]
      real(wp), intent(in) :: strain1(n, 4)
      real(wp), intent(in) :: rotation1(n, 3)
      real(wp), intent(in) :: stress1(n, 4)
      real(wp) :: work

      integer :: i
      real(wp) :: c, s, versine, turned, stretched, skew0, skew1, mixed, ratio, terms(n)

      !$omp simd private(c, s, versine, turned, stretched, skew0, skew1, mixed, ratio)
      do i = 1, n
         s = rotation1(i, 2)*rotation0(i, 1) - rotation1(i, 1)*rotation0(i, 2)
         c = rotation1(i, 1)*rotation0(i, 1) + rotation1(i, 2)*rotation0(i, 2)
         versine = merge(s*s/(1.0_wp + abs(c)), 1.0_wp - c, c > 0.0_wp)
         stretched = (stress0(i, 1) - stress1(i, 1)) + (stress0(i, 2) - stress1(i, 2)) &
            + (stress0(i, 1)*strain1(i, 1) - stress1(i, 1)*strain0(i, 1)) &
            + (stress0(i, 2)*strain1(i, 2) - stress1(i, 2)*strain0(i, 2)) &
            + (stress0(i, 4)*strain1(i, 4) - stress1(i, 4)*strain0(i, 4))
         ! T : (J U) of both states, and of each stress with the other stretch
         skew0 = 0.5_wp*(stress0(i, 2) - stress0(i, 1))*strain0(i, 4) &
            + stress0(i, 4)*(strain0(i, 1) - strain0(i, 2))
         skew1 = 0.5_wp*(stress1(i, 2) - stress1(i, 1))*strain1(i, 4) &
            + stress1(i, 4)*(strain1(i, 1) - strain1(i, 2))
         mixed = 0.5_wp*((stress0(i, 2) - stress0(i, 1))*strain1(i, 4) &
            + (stress1(i, 2) - stress1(i, 1))*strain0(i, 4)) &
            + stress0(i, 4)*(strain1(i, 1) - strain1(i, 2)) &
            + stress1(i, 4)*(strain0(i, 1) - strain0(i, 2))
         ratio = rotation0(i, 3)/rotation1(i, 3)
         turned = mixed - skew0*ratio - skew1/ratio
         terms(i) = 0.5_wp*volume(i)*(s*turned - versine*stretched)
      end do
      work = sum(ordered_sums(n, 1, terms))
   end function chord_sum

end module lithofrac_mechanics_turns
