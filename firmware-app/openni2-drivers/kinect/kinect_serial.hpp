#pragma once

#include <filesystem>
#include <string>

namespace octurn {

/// What tells a Kinect from others: its serial number, as the camera tells it or, where that has
/// none, the microphones beside it; else the place on USB that it is plugged into, as `usb_place`.
/// @param index  among the Kinects that are plugged in, which nobody has open yet
std::string kinect_serial(int index);

/// The place on USB of a Kinect's camera, "usb-1-1.4": bus 1, port 1 of its root, port 4 of the hub
/// there. It stays when the Kinect is plugged in again. Empty if there is none.
/// @param index    among the cameras by bus and address, the order of libusb
/// @param devices  where Linux shows what is plugged in
std::string usb_place(int index, const std::filesystem::path& devices = "/sys/bus/usb/devices");

}  // namespace octurn
