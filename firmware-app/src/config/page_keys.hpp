#pragma once

#include <array>
#include <string_view>

namespace octurn {

/// Keys of octurn.json that the page may not set: where settings are kept, and who may change them,
/// is not for those who may change them. What the rig is built of is measured beside it.
inline constexpr std::array<std::string_view, 3> fixed_keys{"data", "password_file", "sensor"};

/// Keys of its `laser` that the page may set: how pictures are exposed. Of the others some tell
/// where a camera and its lasers stand, and some on which lines lasers are.
inline constexpr std::array<std::string_view, 2> laser_keys_of_page{"exposure_ms", "gain"};

}  // namespace octurn
