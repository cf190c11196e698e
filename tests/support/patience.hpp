#pragma once

#include <chrono>

namespace octurn {

/// The limit of a wait for a state that must come. It says nothing of the machine's speed: it only
/// lets a test that waits in vain say so before CTest ends it.
inline constexpr std::chrono::seconds patience{100};

}  // namespace octurn
