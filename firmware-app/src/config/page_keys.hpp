#pragma once

#include <array>
#include <string_view>

namespace octurn {

/// Keys of octurn.json that the page may not set. Who may change settings must not decide where
/// they are stored or who else may change them. The kind of sensor is set where the rig is built.
inline constexpr std::array<std::string_view, 3> fixed_keys{"data", "password_file", "sensor"};

/// Keys of `laser` in octurn.json that the page may set: the exposure of pictures. The others are
/// the calibration of camera and lasers, and the lasers' GPIO lines.
inline constexpr std::array<std::string_view, 2> laser_keys_of_page{"exposure_ms", "gain"};

}  // namespace octurn
