#pragma once

#include "turntable/motion.hpp"

namespace octurn {

/// A motion whose ramps take 150 steps and 0.3 s each: figures that a test can state.
inline constexpr Motion quick_motion = {
    .start_steps_per_second = 200, .top_steps_per_second = 800, .ramp_steps_per_second2 = 2000};

}  // namespace octurn
