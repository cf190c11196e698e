#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "kinect/emulated/camera.hpp"
#include "kinect/emulated/emulated_kinect.hpp"

namespace octurn {

/// The USB devices of a Kinect, which is a hub with up to three of them.
enum class KinectPart { camera, motor, audio };

inline constexpr std::string_view kinect_serial_number = "A00000000000000A";

inline constexpr std::uint16_t microsoft = 0x045E;
std::uint16_t usb_product(KinectPart part, KinectModel model);
std::uint16_t usb_release(KinectModel model);

/// Only the camera of model 1414 has a serial number of its own; the others have zeros.
std::string_view usb_serial_number(KinectPart part, KinectModel model);

/// The largest packet of an isochronous endpoint: two transactions of 960 bytes a microframe.
inline constexpr int max_iso_packet_bytes = 1920;

/// The eight bytes that begin a control transfer (USB 2.0, 9.3).
struct UsbSetup {
  std::uint8_t type = 0;
  std::uint8_t request = 0;
  std::uint16_t value = 0;
  std::uint16_t index = 0;
  std::uint16_t length = 0;

  bool is_in() const { return (type & 0x80U) != 0; }
};

/// Carries out a vendor request.
/// @param data  the request's data, or the buffer for its reply
/// @return bytes transferred; nothing if the device stalls, as on an unsupported request
std::optional<std::size_t> vendor_request(KinectPart part, const UsbSetup& setup,
                                          EmulatedKinect& kinect, EmulatedCamera& camera,
                                          std::span<std::uint8_t> data);

/// Answers a standard request (USB 2.0, 9.4), as a host sends it to enumerate devices.
/// @return the reply, no longer than was asked for; nothing if the device stalls
std::optional<std::vector<std::uint8_t>> standard_request(KinectPart part, const UsbSetup& setup,
                                                          KinectModel model);

}  // namespace octurn
