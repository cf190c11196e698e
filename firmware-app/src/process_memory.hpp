#pragma once

namespace octurn {

/// Has the C library keep what is freed: each snapshot takes as much as the one before, and to get
/// its pages from the system anew was a tenth of a model's processor time.
void keep_freed_memory();

/// Has the C library return every large block to the system as soon as it is freed. Otherwise it
/// keeps what one thread frees for that thread alone, and a memory limit is passed: by 24 MB with
/// two threads.
void return_freed_memory();

}  // namespace octurn
