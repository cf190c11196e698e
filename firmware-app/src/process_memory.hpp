#pragma once

namespace octurn {

/// Has the C library return every large block to the system as soon as it is freed. Otherwise it
/// keeps what one thread frees for that thread alone, and a memory limit is passed: by 24 MB with
/// two threads.
void return_freed_memory();

}  // namespace octurn
