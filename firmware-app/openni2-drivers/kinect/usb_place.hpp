#pragma once

#include <filesystem>
#include <string>

namespace octurn {

/// The USB port of a Kinect's camera: "usb-1-1.4" is bus 1, port 1 of its root hub, port 4 of the
/// hub there. It stays the same when the Kinect is plugged in again. Empty if there is no such
/// camera.
/// @param index    among the cameras by bus and address
/// @param devices  sysfs folder of USB devices
std::string usb_place(int index, const std::filesystem::path& devices = "/sys/bus/usb/devices");

}  // namespace octurn
