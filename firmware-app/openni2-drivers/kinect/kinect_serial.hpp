#pragma once

#include <filesystem>
#include <string>

namespace octurn {

/// Identifies a Kinect among others: the serial number of its camera or, if that has none, of its
/// microphones, as libfreenect reads it; else its USB port, by `usb_place`.
/// @param index  among the Kinects that are plugged in; the Kinect must not be open yet
std::string kinect_serial(int index);

/// The USB port of a Kinect's camera: "usb-1-1.4" is bus 1, port 1 of its root hub, port 4 of the
/// hub there. It stays the same when the Kinect is plugged in again. Empty if there is no such
/// camera.
/// @param index    among the cameras by bus and address, the order of libusb
/// @param devices  sysfs folder of USB devices
std::string usb_place(int index, const std::filesystem::path& devices = "/sys/bus/usb/devices");

}  // namespace octurn
