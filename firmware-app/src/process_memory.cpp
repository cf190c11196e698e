#include "process_memory.hpp"

#include <malloc.h>

namespace octurn {
namespace {

constexpr int large_block_bytes = 1 << 18;  // below the blocks that voxels are stored in

}  // namespace

void return_freed_memory() { ::mallopt(M_MMAP_THRESHOLD, large_block_bytes); }

}  // namespace octurn
