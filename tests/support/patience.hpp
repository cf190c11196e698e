#pragma once

#include <chrono>

namespace octurn {

/// Timeout of a wait for a state that must come. It does not depend on the machine's speed; it only
/// lets a test that waits in vain report that before CTest's timeout ends it.
inline constexpr std::chrono::seconds patience{100};

}  // namespace octurn
