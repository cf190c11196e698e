#include "process_memory.hpp"

#include <malloc.h>

#include <limits>

namespace octurn {
namespace {

constexpr int large_block_bytes = 1 << 18;  // smaller than the blocks that store voxels

constexpr int kept_bytes = 1 << 25;  // glibc's maximum of M_MMAP_THRESHOLD on 64 bit

}  // namespace

void keep_freed_memory() {
  ::mallopt(M_MMAP_THRESHOLD, kept_bytes);
  ::mallopt(M_TRIM_THRESHOLD, std::numeric_limits<int>::max());
}

void return_freed_memory() { ::mallopt(M_MMAP_THRESHOLD, large_block_bytes); }

}  // namespace octurn
