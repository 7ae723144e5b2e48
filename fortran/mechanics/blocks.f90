!> Fixed partition of chunks and nodes, so that sums never depend on the number of threads.
!>
!> Element forces go to a buffer with one place for every node, for the first block of chunks that
!> uses it, and one more for each other block that does: no two blocks write to one place. A node
!> then adds its further places in order of blocks. Nodes that cracks have added are as cheap as
!> any: numbers need not be near each other.
module lithofrac_mechanics_blocks
   use lithofrac_base_kinds, only: wp
   use lithofrac_mechanics_chunks, only: chunks_type, width
   use lithofrac_mesh_mesh, only: mesh_type
   implicit none
   private

   public :: assemble, blocks_type, new_blocks

   integer, parameter :: nodes_in_block = 512  !! longest run of nodes updated together

   type :: blocks_type
      integer :: n_blocks = 0                    !! blocks of chunks
      integer, allocatable :: first_chunk(:)     !! (n_blocks + 1)
      integer, allocatable :: place(:, :, :)     !! (width, 3, n_chunks) place of a corner
      real(wp), allocatable :: buffer(:, :)      !! (2, places) element forces [N], 0 between steps
      real(wp), allocatable :: chord(:)          !! (n_blocks) `chord_work` of the step [J]
      integer :: n_runs = 0                      !! runs of nodes of one body
      integer, allocatable :: first_node(:)      !! (n_runs + 1)
      integer, allocatable :: first_shared(:)    !! (n_runs + 1) into `shared`
      integer, allocatable :: shared(:, :)       !! (2, n) node and its further place, by block
   end type blocks_type

contains

   !> Partition by the mesh alone; the number of threads plays no part.
   subroutine new_blocks(blocks, chunks, mesh)
      type(blocks_type), intent(out) :: blocks
      type(chunks_type), intent(in) :: chunks
      type(mesh_type), intent(in) :: mesh

      integer :: block
      integer, allocatable :: shared(:, :)

      blocks%n_blocks = min(chunks%n_chunks, max(8, chunks%n_chunks/32))
      allocate (blocks%first_chunk(blocks%n_blocks + 1))
      do block = 0, blocks%n_blocks
         blocks%first_chunk(block + 1) = 1 + (block*chunks%n_chunks)/blocks%n_blocks
      end do
      call find_places(blocks, chunks, mesh%n_nodes, shared)
      allocate (blocks%buffer(2, mesh%n_nodes + size(shared, 2)), source=0.0_wp)
      allocate (blocks%chord(blocks%n_blocks), source=0.0_wp)
      call cut_runs(blocks, mesh)
      call sort_shared(blocks, shared)
   end subroutine new_blocks

   !> Places of the corners; and the nodes that a further block uses, with their place in it.
   subroutine find_places(blocks, chunks, n_nodes, shared)
      type(blocks_type), intent(inout) :: blocks
      type(chunks_type), intent(in) :: chunks
      integer, intent(in) :: n_nodes
      integer, allocatable, intent(out) :: shared(:, :)  !! (2, n) node, place; in order of blocks

      integer :: block, chunk, lane, k, node, n
      integer, allocatable :: last_use(:), place_of(:)

      allocate (last_use(n_nodes), place_of(n_nodes), source=0)
      allocate (blocks%place(width, 3, chunks%n_chunks))
      allocate (shared(2, 3*width*chunks%n_chunks))
      n = 0
      do block = 1, blocks%n_blocks
         do chunk = blocks%first_chunk(block), blocks%first_chunk(block + 1) - 1
            do k = 1, 3
               do lane = 1, width
                  node = chunks%node(lane, k, chunk)
                  if (last_use(node) == 0) then
                     place_of(node) = node
                  else if (last_use(node) /= block) then
                     n = n + 1
                     place_of(node) = n_nodes + n
                     shared(:, n) = [node, n_nodes + n]
                  end if
                  last_use(node) = block
                  blocks%place(lane, k, chunk) = place_of(node)
               end do
            end do
         end do
      end do
      shared = shared(:, :n)
   end subroutine find_places

   !> Runs of consecutive nodes of one body.
   subroutine cut_runs(blocks, mesh)
      type(blocks_type), intent(inout) :: blocks
      type(mesh_type), intent(in) :: mesh

      integer :: node
      integer, allocatable :: first(:)

      allocate (first(mesh%n_nodes + 1))
      do node = 1, mesh%n_nodes
         if (node > 1) then
            if (mesh%body_of_node(node) == mesh%body_of_node(node - 1) &
               .and. node - first(blocks%n_runs) < nodes_in_block) cycle
         end if
         blocks%n_runs = blocks%n_runs + 1
         first(blocks%n_runs) = node
      end do
      first(blocks%n_runs + 1) = mesh%n_nodes + 1
      blocks%first_node = first(:blocks%n_runs + 1)
   end subroutine cut_runs

   !> Further places of each run of nodes; those of one node stay in order of blocks.
   subroutine sort_shared(blocks, shared)
      type(blocks_type), intent(inout) :: blocks
      integer, intent(in) :: shared(:, :)   !! (2, n) node, place

      integer :: i, run, next(blocks%n_runs)
      integer, allocatable :: run_of(:)

      allocate (run_of(blocks%first_node(blocks%n_runs + 1) - 1))
      allocate (blocks%first_shared(blocks%n_runs + 1), source=0)
      do run = 1, blocks%n_runs
         run_of(blocks%first_node(run):blocks%first_node(run + 1) - 1) = run
      end do
      do i = 1, size(shared, 2)
         run = run_of(shared(1, i))
         blocks%first_shared(run + 1) = blocks%first_shared(run + 1) + 1
      end do
      blocks%first_shared(1) = 1
      do run = 1, blocks%n_runs
         next(run) = blocks%first_shared(run)
         blocks%first_shared(run + 1) = blocks%first_shared(run + 1) + blocks%first_shared(run)
      end do
      allocate (blocks%shared(2, size(shared, 2)))
      do i = 1, size(shared, 2)
         run = run_of(shared(1, i))
         blocks%shared(:, next(run)) = shared(:, i)
         next(run) = next(run) + 1
      end do
   end subroutine sort_shared

   !> Internal force of the nodes of one run, summed over blocks in their order; empties the buffer.
   pure subroutine assemble(blocks, run, force)
      type(blocks_type), intent(inout) :: blocks
      integer, intent(in) :: run
      real(wp), intent(inout), contiguous :: force(:, :)  !! (2, n_nodes) [N]

      call sum_places(blocks%first_node(run), blocks%first_node(run + 1) - 1, &
         blocks%shared(:, blocks%first_shared(run):blocks%first_shared(run + 1) - 1), &
         size(blocks%buffer, 2), blocks%buffer, size(force, 2), force)
   end subroutine assemble

   !> The same with arrays of known shape, whose columns are copied without a call for each.
   pure subroutine sum_places(first, last, shared, n_places, buffer, n_nodes, force)
      integer, intent(in) :: first, last                !! nodes of the run
      integer, intent(in), contiguous :: shared(:, :)   !! (2, n) node and its further place
      integer, intent(in) :: n_places, n_nodes
      real(wp), intent(inout) :: buffer(2, n_places)    !! [N]
      real(wp), intent(inout) :: force(2, n_nodes)      !! [N]

      integer :: i, place, node

      force(:, first:last) = buffer(:, first:last)
      buffer(:, first:last) = 0.0_wp
      do i = 1, size(shared, 2)
         node = shared(1, i)
         place = shared(2, i)
         force(:, node) = force(:, node) + buffer(:, place)
         buffer(:, place) = 0.0_wp
      end do
   end subroutine sum_places

end module lithofrac_mechanics_blocks
