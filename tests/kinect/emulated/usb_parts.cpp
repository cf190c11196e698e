#include "kinect/emulated/usb_parts.hpp"

#include <algorithm>
#include <array>

namespace octurn {
namespace {

using Bytes = std::vector<std::uint8_t>;

constexpr std::uint8_t low(std::uint16_t value) { return static_cast<std::uint8_t>(value & 0xFFU); }
constexpr std::uint8_t high(std::uint16_t value) { return static_cast<std::uint8_t>(value >> 8U); }

/// The motor's state with the acceleration, big-endian.
std::size_t reply_of_motor(const EmulatedKinect& kinect, std::span<std::uint8_t> reply) {
  std::array<std::uint8_t, 10> state = {};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto counts = static_cast<std::uint16_t>(kinect.acceleration[axis].load());
    state[2 + 2 * axis] = high(counts);
    state[3 + 2 * axis] = low(counts);
  }
  const std::size_t size = std::min(state.size(), reply.size());
  std::copy_n(state.begin(), size, reply.begin());
  return size;
}

Bytes device_descriptor(KinectPart part, KinectModel model) {
  const std::uint16_t product = usb_product(part, model);
  const std::uint16_t release = usb_release(model);
  return {18,
          1,
          0x00,
          0x02,
          0,
          0,
          0,
          64,
          low(microsoft),
          high(microsoft),
          low(product),
          high(product),
          low(release),
          high(release),
          2,
          1,
          3,
          1};
}

/// A configuration with one vendor-specific interface. The camera's interface has an endpoint for
/// video and one for depth.
Bytes configuration_descriptor(KinectPart part) {
  const bool is_camera = part == KinectPart::camera;
  const std::uint8_t endpoints = is_camera ? 2 : 0;
  const auto total = static_cast<std::uint8_t>(18 + 7 * endpoints);
  Bytes bytes = {9, 2, total, 0, 1, 1, 0, 0xC0, 50, 9, 4, 0, 0, endpoints, 0xFF, 0, 0, 0};
  for (std::uint8_t endpoint = 0x81; endpoint < 0x81 + endpoints; ++endpoint) {
    // wMaxPacketSize: 960 bytes, one additional transaction per microframe
    bytes.insert(bytes.end(), {7, 5, endpoint, 1, low(0x0800 + 960), high(0x0800 + 960), 1});
  }
  return bytes;
}

Bytes string_descriptor(std::string_view text) {
  Bytes bytes = {static_cast<std::uint8_t>(2 + 2 * text.size()), 3};
  for (const char letter : text) {
    bytes.insert(bytes.end(), {static_cast<std::uint8_t>(letter), 0});
  }
  return bytes;
}

std::optional<Bytes> descriptor(KinectPart part, std::uint16_t value, KinectModel model) {
  const std::uint8_t index = low(value);
  switch (high(value)) {
    case 1:
      return device_descriptor(part, model);
    case 2:
      return configuration_descriptor(part);
    case 3:
      switch (index) {
        case 0:
          return Bytes{4, 3, 0x09, 0x04};  // language: US English
        case 1:
          return string_descriptor(part == KinectPart::camera  ? "Xbox NUI Camera"
                                   : part == KinectPart::motor ? "Xbox NUI Motor"
                                                               : "Xbox NUI Audio");
        case 2:
          return string_descriptor("Microsoft");
        case 3:
          return string_descriptor(usb_serial_number(part, model));
        default:
          return std::nullopt;
      }
    default:
      return std::nullopt;
  }
}

}  // namespace

std::uint16_t usb_product(KinectPart part, KinectModel model) {
  const bool for_windows = model == KinectModel::for_windows;
  switch (part) {
    case KinectPart::motor:
      return 0x02B0;
    case KinectPart::camera:
      return for_windows ? 0x02BF : 0x02AE;
    default:
      return for_windows ? 0x02BE : 0x02AD;
  }
}

std::uint16_t usb_release(KinectModel model) {
  return model == KinectModel::k1414 ? 0x010B : 0x0114;
}

std::string_view usb_serial_number(KinectPart part, KinectModel model) {
  const bool has_none = part == KinectPart::camera && model != KinectModel::k1414;
  return has_none ? "0000000000000000" : kinect_serial_number;
}

std::optional<std::size_t> vendor_request(KinectPart part, const UsbSetup& setup,
                                          EmulatedKinect& kinect, EmulatedCamera& camera,
                                          std::span<std::uint8_t> data) {
  if (part == KinectPart::motor && setup.is_in() && setup.request == 0x32) {
    return reply_of_motor(kinect, data);
  }
  if (part != KinectPart::camera) {
    return setup.is_in() ? std::nullopt : std::optional(std::size_t{0});
  }
  if (kinect.stalls > 0) {
    --kinect.stalls;
    return std::nullopt;
  }
  if (!setup.is_in()) {
    return camera.command(data) ? std::optional(data.size()) : std::nullopt;
  }
  const std::vector<std::uint8_t> reply = camera.take_reply();
  const std::size_t size = std::min(reply.size(), data.size());
  std::copy_n(reply.begin(), size, data.begin());
  return size;
}

std::optional<std::vector<std::uint8_t>> standard_request(KinectPart part, const UsbSetup& setup,
                                                          KinectModel model) {
  std::optional<Bytes> reply;
  switch (setup.request) {
    case 0:  // GET_STATUS: self-powered
      reply = Bytes{1, 0};
      break;
    case 6:
      reply = descriptor(part, setup.value, model);
      break;
    case 8:  // GET_CONFIGURATION
      reply = Bytes{1};
      break;
    case 10:  // GET_INTERFACE
      reply = Bytes{0};
      break;
    default:
      reply = setup.is_in() ? std::nullopt : std::optional(Bytes());
  }
  if (reply && reply->size() > setup.length) {
    reply->resize(setup.length);
  }
  return reply;
}

}  // namespace octurn
