!> Elements laid out for speed: chunks of equal width, structure of arrays, one body a chunk.
!>
!> A chunk shares one material, so its constants are read once. The last chunk of a body is
!> padded with elements of zero volume and zero gradients: they carry no force and no strain.
module lithofrac_mechanics_chunks
   use lithofrac_base_kinds, only: wp
   use lithofrac_mesh_mesh, only: mesh_type, triangle_area
   implicit none
   private

   public :: chunks_type, new_chunks, set_corners, width

   integer, parameter :: width = 128  !! elements in a chunk

   type :: chunks_type
      integer :: n_chunks = 0
      logical :: axisymmetric = .false.
      integer, allocatable :: node(:, :, :)         !! (width, 3, n_chunks)
      !> (width, 4, n_chunks) dN2/dX, dN2/dY, dN3/dX, dN3/dY [1/m]
      real(wp), allocatable :: gradient(:, :, :)
      real(wp), allocatable :: volume(:, :)         !! (width, n_chunks) [m3] per metre or radian
      real(wp), allocatable :: hoop(:, :)           !! (width, n_chunks) 1/(3 mean radius) [1/m]
      integer, allocatable :: body(:)               !! (n_chunks)
      integer, allocatable :: filled(:)             !! (n_chunks) lanes that hold an element
      integer, allocatable :: element(:, :)         !! (width, n_chunks) 0 in padding
      integer, allocatable :: lane_of(:)            !! (n_elements)
      integer, allocatable :: chunk_of(:)           !! (n_elements)
   end type chunks_type

contains

   !> Lay out the elements of `mesh`, in order of bodies, keeping their order within a body.
   subroutine new_chunks(chunks, mesh, axisymmetric, alive)
      type(chunks_type), intent(out) :: chunks
      type(mesh_type), intent(in) :: mesh
      logical, intent(in) :: axisymmetric   !! first coordinate is the radius
      logical, intent(in) :: alive(:)       !! (>= n_elements) elements that were cut have no lane

      integer :: body, element, chunk, lane, n

      chunks%axisymmetric = axisymmetric
      do body = 1, mesh%n_bodies
         n = count(alive(:mesh%n_elements) .and. mesh%body(:mesh%n_elements) == body)
         chunks%n_chunks = chunks%n_chunks + (n + width - 1)/width
      end do
      call allocate_chunks(chunks, mesh%n_elements)
      chunk = 0
      do body = 1, mesh%n_bodies
         lane = width
         do element = 1, mesh%n_elements
            if (mesh%body(element) /= body .or. .not. alive(element)) cycle
            if (lane == width) then
               chunk = chunk + 1
               lane = 0
               chunks%body(chunk) = body
               chunks%node(:, :, chunk) = mesh%triangles(1, element)
            end if
            lane = lane + 1
            chunks%filled(chunk) = lane
            call place(chunks, mesh, element, lane, chunk)
         end do
      end do
   end subroutine new_chunks

   subroutine allocate_chunks(chunks, n_elements)
      type(chunks_type), intent(inout) :: chunks
      integer, intent(in) :: n_elements

      associate (n => chunks%n_chunks)
         allocate (chunks%node(width, 3, n))
         allocate (chunks%gradient(width, 4, n), source=0.0_wp)
         allocate (chunks%volume(width, n), source=0.0_wp)
         allocate (chunks%hoop(width, merge(n, 0, chunks%axisymmetric)), source=0.0_wp)
         allocate (chunks%body(n), chunks%filled(n))
         allocate (chunks%element(width, n), source=0)
         allocate (chunks%lane_of(n_elements), chunks%chunk_of(n_elements), source=0)
      end associate
   end subroutine allocate_chunks

   subroutine place(chunks, mesh, element, lane, chunk)
      type(chunks_type), intent(inout) :: chunks
      type(mesh_type), intent(in) :: mesh
      integer, intent(in) :: element
      integer, intent(in) :: lane
      integer, intent(in) :: chunk

      real(wp) :: a(2), b(2), c(2), double_area

      associate (corner => mesh%triangles(:, element))
         a = mesh%nodes(:, corner(1))
         b = mesh%nodes(:, corner(2))
         c = mesh%nodes(:, corner(3))
         chunks%node(lane, :, chunk) = corner
      end associate
      double_area = 2.0_wp*triangle_area(a, b, c)
      chunks%gradient(lane, :, chunk) = [c(2) - a(2), a(1) - c(1), a(2) - b(2), b(1) - a(1)] &
         /double_area
      chunks%volume(lane, chunk) = 0.5_wp*double_area
      if (chunks%axisymmetric) then
         chunks%hoop(lane, chunk) = 1.0_wp/(a(1) + b(1) + c(1))
         chunks%volume(lane, chunk) = 0.5_wp*double_area*(a(1) + b(1) + c(1))/3.0_wp
      end if
      chunks%element(lane, chunk) = element
      chunks%lane_of(element) = lane
      chunks%chunk_of(element) = chunk
   end subroutine place

   !> Take over the corners of an element that has been given copies of its nodes; a copy stands
   !> where its node stood, so gradients and volume stay.
   pure subroutine set_corners(chunks, mesh, element)
      type(chunks_type), intent(inout) :: chunks
      type(mesh_type), intent(in) :: mesh
      integer, intent(in) :: element

      chunks%node(chunks%lane_of(element), :, chunks%chunk_of(element)) = mesh%triangles(:, element)
   end subroutine set_corners

end module lithofrac_mechanics_chunks
