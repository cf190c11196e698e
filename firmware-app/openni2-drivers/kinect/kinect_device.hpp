#pragma once

#include <string_view>

namespace octurn {

/// What programs know of the devices of Octurn's Kinect driver.

/// How the URI of every Kinect begins. Alone it is the first one found, with a number after it
/// (`kinect://1`) the one of that index.
inline constexpr std::string_view kinect_scheme = "kinect://";

/// The property that is a Kinect's Tilt, by its accelerometer; supported only where it can be read.
/// Models 1473 and for Windows would need firmware that Octurn may not ship.
inline constexpr int tilt_property = 0x4F430011;

/// The property that is an OniBool: whether depth begins at 0.4 m and not at 0.8 m. Only a Kinect
/// for Windows has it, and it is set before the stream starts.
inline constexpr int near_mode_property = 0x4F430012;

/// The property that is an int: how many frames came damaged since the device was opened.
inline constexpr int damaged_frames_property = 0x4F430013;

}  // namespace octurn
