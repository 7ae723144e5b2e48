!> Coulomb contact of one pair, in closed form.
!>
!> Unknown is the impulse p between two points with compliance W = diag(w): the relative velocity
!> after it is d = d0 + W p. A face of normal n asks for d.n + b >= 0, an impulse only where that
!> is an equality, and friction within mu of the normal impulse that opposes the slip. Friction
!> acts on the velocity: a stuck pair has no tangential spring and does not creep.
module lithofrac_contact_friction
   use lithofrac_base_kinds, only: wp
   implicit none
   private

   public :: one_face, two_faces

contains

   !> Impulse at one face.
   pure function one_face(d0, normal, bias, mu, w) result(p)
      real(wp), intent(in) :: d0(2)       !! relative velocity without the impulse [m/s]
      real(wp), intent(in) :: normal(2)   !! unit, away from the face
      real(wp), intent(in) :: bias        !! b [m/s]
      real(wp), intent(in) :: mu          !! friction coefficient
      real(wp), intent(in) :: w(2)        !! compliance, > 0 [1/kg]
      real(wp) :: p(2)                    !! [N s]

      real(wp) :: tangent(2), approach, along

      p = 0.0_wp
      approach = dot_product(d0, normal) + bias
      if (approach >= 0.0_wp) return
      if (mu <= 0.0_wp) then
         p = -approach/dot_product(normal, w*normal)*normal
         return
      end if
      tangent = [-normal(2), normal(1)]
      p = (-bias*normal - d0)/w
      along = dot_product(p, tangent)
      if (abs(along) <= mu*dot_product(p, normal)) return
      p = sliding(d0, normal, tangent, approach, mu, w)
   end function one_face

   !> Impulse of a pair that slides: on the edge of the friction cone, against the slip.
   pure function sliding(d0, normal, tangent, approach, mu, w) result(p)
      real(wp), intent(in) :: d0(2)
      real(wp), intent(in) :: normal(2)
      real(wp), intent(in) :: tangent(2)
      real(wp), intent(in) :: approach    !! d0.n + b < 0 [m/s]
      real(wp), intent(in) :: mu
      real(wp), intent(in) :: w(2)
      real(wp) :: p(2)

      real(wp) :: ray(2), stiffness, size_of_p, smallest, side
      integer :: k

      p = -approach/dot_product(normal, w*normal)*normal
      smallest = huge(1.0_wp)
      do k = 1, 2
         side = 3.0_wp - 2.0_wp*k
         ray = normal + side*mu*tangent
         stiffness = dot_product(normal, w*ray)
         if (stiffness <= 0.0_wp) cycle
         size_of_p = -approach/stiffness
         if (side*dot_product(d0 + size_of_p*w*ray, tangent) <= 0.0_wp) then
            p = size_of_p*ray
            return
         end if
         ! no slip direction fits (unequal compliances): the smaller impulse is the safe one
         if (size_of_p < smallest) then
            smallest = size_of_p
            p = size_of_p*ray
         end if
      end do
   end function sliding

   !> Impulse at a re-entrant pair of faces: both inequalities hold at once.
   pure function two_faces(d0, normal, bias, mu, w) result(p)
      real(wp), intent(in) :: d0(2)
      real(wp), intent(in) :: normal(2, 2)  !! (component, face)
      real(wp), intent(in) :: bias(2)
      real(wp), intent(in) :: mu
      real(wp), intent(in) :: w(2)
      real(wp) :: p(2)

      real(wp) :: noise, determinant, d(2)
      integer :: face

      noise = 1.0e-13_wp*(sum(abs(d0)) + sum(abs(bias)))
      p = 0.0_wp
      if (is_open(d0, 1) .and. is_open(d0, 2)) return
      do face = 1, 2
         p = one_face(d0, normal(:, face), bias(face), mu, w)
         if (any(abs(p) > 0.0_wp) .and. is_open(d0 + w*p, 3 - face)) return
      end do
      determinant = normal(1, 1)*normal(2, 2) - normal(2, 1)*normal(1, 2)
      if (abs(determinant) < 1.0e-9_wp) then
         p = one_face(d0, normal(:, 1), minval(bias), mu, w)
         return
      end if
      d = [normal(2, 1)*bias(2) - normal(2, 2)*bias(1), &
         normal(1, 2)*bias(1) - normal(1, 1)*bias(2)]/determinant
      p = (d - d0)/w

   contains

      pure logical function is_open(velocity, side)
         real(wp), intent(in) :: velocity(2)
         integer, intent(in) :: side

         is_open = dot_product(velocity, normal(:, side)) + bias(side) >= -noise
      end function is_open

   end function two_faces

end module lithofrac_contact_friction
