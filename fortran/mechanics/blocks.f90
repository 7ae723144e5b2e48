!> Fixed partition of chunks and nodes, so that sums never depend on the number of threads.
!>
!> Each block of chunks adds its element forces to its own buffer, which covers the range of
!> node numbers that the block uses. A node then sums over the buffers in order of blocks.
module lithofrac_mechanics_blocks
   use lithofrac_base_kinds, only: wp
   use lithofrac_mechanics_chunks, only: chunks_type
   use lithofrac_mesh_mesh, only: mesh_type
   implicit none
   private

   public :: assemble, blocks_type, new_blocks

   integer, parameter :: nodes_in_block = 512  !! longest run of nodes updated together

   type :: blocks_type
      integer :: n_blocks = 0                    !! blocks of chunks
      integer, allocatable :: first_chunk(:)     !! (n_blocks + 1)
      integer, allocatable :: low(:), high(:)    !! (n_blocks) range of node numbers
      integer, allocatable :: offset(:)          !! (n_blocks) where a buffer starts, minus 1
      real(wp), allocatable :: buffer(:, :)      !! (2, sum of ranges) element forces [N]
      integer :: n_runs = 0                      !! runs of nodes of one body
      integer, allocatable :: first_node(:)      !! (n_runs + 1)
      integer, allocatable :: first_source(:)    !! (n_runs + 1) into `source`
      integer, allocatable :: source(:)          !! blocks that reach into a run, ascending
   end type blocks_type

contains

   !> Partition by the mesh alone; the number of threads plays no part.
   subroutine new_blocks(blocks, chunks, mesh)
      type(blocks_type), intent(out) :: blocks
      type(chunks_type), intent(in) :: chunks
      type(mesh_type), intent(in) :: mesh

      integer :: block

      blocks%n_blocks = min(chunks%n_chunks, max(8, chunks%n_chunks/32))
      allocate (blocks%first_chunk(blocks%n_blocks + 1))
      do block = 0, blocks%n_blocks
         blocks%first_chunk(block + 1) = 1 + (block*chunks%n_chunks)/blocks%n_blocks
      end do
      allocate (blocks%low(blocks%n_blocks), blocks%high(blocks%n_blocks))
      allocate (blocks%offset(blocks%n_blocks), source=0)
      do block = 1, blocks%n_blocks
         associate (node => chunks%node(:, :, &
               blocks%first_chunk(block):blocks%first_chunk(block + 1) - 1))
            blocks%low(block) = minval(node)
            blocks%high(block) = maxval(node)
         end associate
         if (block == 1) cycle
         blocks%offset(block) = blocks%offset(block - 1) &
            + blocks%high(block - 1) - blocks%low(block - 1) + 1
      end do
      allocate (blocks%buffer(2, sum(blocks%high - blocks%low + 1)), source=0.0_wp)
      call cut_runs(blocks, mesh)
      call find_sources(blocks)
   end subroutine new_blocks

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

   subroutine find_sources(blocks)
      type(blocks_type), intent(inout) :: blocks

      integer :: run, block, n, pass

      allocate (blocks%first_source(blocks%n_runs + 1))
      do pass = 1, 2
         n = 0
         do run = 1, blocks%n_runs
            blocks%first_source(run) = n + 1
            do block = 1, blocks%n_blocks
               if (blocks%high(block) < blocks%first_node(run)) cycle
               if (blocks%low(block) >= blocks%first_node(run + 1)) cycle
               n = n + 1
               if (pass == 2) blocks%source(n) = block
            end do
         end do
         blocks%first_source(blocks%n_runs + 1) = n + 1
         if (pass == 1) allocate (blocks%source(n))
      end do
   end subroutine find_sources

   !> Internal force of the nodes of one run, summed over blocks in their order.
   pure subroutine assemble(blocks, run, force)
      type(blocks_type), intent(in) :: blocks
      integer, intent(in) :: run
      real(wp), intent(inout), contiguous :: force(:, :)  !! (2, n_nodes) [N]

      integer :: i, low, high, node, shift

      force(:, blocks%first_node(run):blocks%first_node(run + 1) - 1) = 0.0_wp
      do i = blocks%first_source(run), blocks%first_source(run + 1) - 1
         associate (block => blocks%source(i))
            low = max(blocks%low(block), blocks%first_node(run))
            high = min(blocks%high(block), blocks%first_node(run + 1) - 1)
            shift = blocks%offset(block) - blocks%low(block) + 1
            do node = low, high
               force(1, node) = force(1, node) + blocks%buffer(1, node + shift)
               force(2, node) = force(2, node) + blocks%buffer(2, node + shift)
            end do
         end associate
      end do
   end subroutine assemble

end module lithofrac_mechanics_blocks
