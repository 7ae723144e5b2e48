!> Fixed partition of chunks and nodes, so that sums never depend on the number of threads.
!>
!> Each block of chunks adds its element forces to its own buffer, which has one place for every
!> node that the block uses, in order of nodes. A node then sums over the buffers in order of
!> blocks. Nodes that cracks have added are as cheap as any: numbers need not be near each other.
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
      integer, allocatable :: first_place(:)     !! (n_blocks + 1) places of a block
      integer, allocatable :: node(:)            !! (places) ascending within a block
      integer, allocatable :: place(:, :, :)     !! (width, 3, n_chunks) place of a corner
      real(wp), allocatable :: buffer(:, :)      !! (2, places) element forces [N]
      real(wp), allocatable :: chord(:)          !! (n_blocks) `chord_work` of the step [J]
      integer :: n_runs = 0                      !! runs of nodes of one body
      integer, allocatable :: first_node(:)      !! (n_runs + 1)
      integer, allocatable :: first_source(:)    !! (n_runs + 1) into `source`
      integer, allocatable :: source(:, :)       !! (2, n) first and last place, by block
   end type blocks_type

contains

   !> Partition by the mesh alone; the number of threads plays no part.
   subroutine new_blocks(blocks, chunks, mesh)
      type(blocks_type), intent(out) :: blocks
      type(chunks_type), intent(in) :: chunks
      type(mesh_type), intent(in) :: mesh

      integer :: block, n
      integer :: node(3*width*chunks%n_chunks), last_use(mesh%n_nodes), place_of(mesh%n_nodes)

      blocks%n_blocks = min(chunks%n_chunks, max(8, chunks%n_chunks/32))
      allocate (blocks%first_chunk(blocks%n_blocks + 1), blocks%first_place(blocks%n_blocks + 1))
      allocate (blocks%place(width, 3, chunks%n_chunks))
      do block = 0, blocks%n_blocks
         blocks%first_chunk(block + 1) = 1 + (block*chunks%n_chunks)/blocks%n_blocks
      end do
      last_use = 0
      n = 0
      do block = 1, blocks%n_blocks
         blocks%first_place(block) = n + 1
         call list_nodes(blocks, block, chunks, last_use, place_of, node, n)
      end do
      blocks%first_place(blocks%n_blocks + 1) = n + 1
      blocks%node = node(:n)
      allocate (blocks%buffer(2, n), blocks%chord(blocks%n_blocks), source=0.0_wp)
      call cut_runs(blocks, mesh)
      call find_sources(blocks)
   end subroutine new_blocks

   !> Nodes of a block, ascending, behind the first `n`; and the places of its corners.
   subroutine list_nodes(blocks, block, chunks, last_use, place_of, node, n)
      type(blocks_type), intent(inout) :: blocks
      integer, intent(in) :: block
      type(chunks_type), intent(in) :: chunks
      integer, intent(inout) :: last_use(:)   !! (n_nodes) last block that has used a node
      integer, intent(inout) :: place_of(:)   !! (n_nodes) working space
      integer, intent(inout) :: node(:)
      integer, intent(inout) :: n

      integer :: chunk, lane, k, i, low, high

      low = huge(low)
      high = 0
      do chunk = blocks%first_chunk(block), blocks%first_chunk(block + 1) - 1
         do k = 1, 3
            do lane = 1, width
               i = chunks%node(lane, k, chunk)
               last_use(i) = block
               low = min(low, i)
               high = max(high, i)
            end do
         end do
      end do
      do i = low, high
         if (last_use(i) /= block) cycle
         n = n + 1
         node(n) = i
         place_of(i) = n
      end do
      do chunk = blocks%first_chunk(block), blocks%first_chunk(block + 1) - 1
         do k = 1, 3
            do lane = 1, width
               blocks%place(lane, k, chunk) = place_of(chunks%node(lane, k, chunk))
            end do
         end do
      end do
   end subroutine list_nodes

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

   !> Places that reach into each run of nodes, in order of blocks.
   subroutine find_sources(blocks)
      type(blocks_type), intent(inout) :: blocks

      integer :: run, block, n, next(blocks%n_blocks), last(blocks%n_blocks)

      allocate (blocks%first_source(blocks%n_runs + 1))
      allocate (blocks%source(2, blocks%n_runs*blocks%n_blocks))
      next = blocks%first_place(:blocks%n_blocks)
      n = 0
      do run = 1, blocks%n_runs
         blocks%first_source(run) = n + 1
         do block = 1, blocks%n_blocks
            last(block) = next(block) - 1
            do while (last(block) < blocks%first_place(block + 1) - 1)
               if (blocks%node(last(block) + 1) >= blocks%first_node(run + 1)) exit
               last(block) = last(block) + 1
            end do
            if (last(block) < next(block)) cycle
            n = n + 1
            blocks%source(:, n) = [next(block), last(block)]
            next(block) = last(block) + 1
         end do
      end do
      blocks%first_source(blocks%n_runs + 1) = n + 1
      blocks%source = blocks%source(:, :n)
   end subroutine find_sources

   !> Internal force of the nodes of one run, summed over blocks in their order.
   pure subroutine assemble(blocks, run, force)
      type(blocks_type), intent(in) :: blocks
      integer, intent(in) :: run
      real(wp), intent(inout), contiguous :: force(:, :)  !! (2, n_nodes) [N]

      integer :: i, place, node

      force(:, blocks%first_node(run):blocks%first_node(run + 1) - 1) = 0.0_wp
      do i = blocks%first_source(run), blocks%first_source(run + 1) - 1
         do place = blocks%source(1, i), blocks%source(2, i)
            node = blocks%node(place)
            force(1, node) = force(1, node) + blocks%buffer(1, place)
            force(2, node) = force(2, node) + blocks%buffer(2, place)
         end do
      end do
   end subroutine assemble

end module lithofrac_mechanics_blocks
