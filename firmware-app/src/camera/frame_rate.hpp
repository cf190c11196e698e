#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace octurn {

/// The kernel's devices of a USB camera, which libcamera does not tell: it knows no rates of USB
/// cameras either.
/// @param camera_id  as libcamera has it: its controller, port and interface, and USB IDs
/// @param sys        where sysfs is mounted
/// @return such as "/dev/video0"; none of a camera that is not on USB
std::vector<std::filesystem::path> video_devices(const std::string& camera_id,
                                                 const std::filesystem::path& sys = "/sys");

/// The most pictures a second that one of the devices makes in a format; 0 if none tells it.
/// @param format  a FourCC of V4L2
double fastest_rate_hz(const std::vector<std::filesystem::path>& devices, std::uint32_t format,
                       unsigned width, unsigned height);

}  // namespace octurn
