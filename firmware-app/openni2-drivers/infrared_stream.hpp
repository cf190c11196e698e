#pragma once

#include <Driver/OniDriverAPI.h>

#include <chrono>
#include <cstdint>
#include <functional>
#include <span>

namespace octurn {

/// The infrared stream of a Kinect v1, real or simulated: GRAY8, 640 x 480, 30 frames a second, as
/// the camera sees the room and its projector's dots.
class InfraredStream : public oni::driver::StreamBase {
 public:
  static constexpr OniVideoMode video_mode = {ONI_PIXEL_FORMAT_GRAY8, 640, 480, 30};

  OniBool isPropertySupported(int property) override;
  OniStatus getProperty(int property, void* data, int* size) override;
  OniStatus setProperty(int property, const void* data, int size) override;

 protected:
  /// Hands a picture to OpenNI2, or drops it if all of OpenNI2's buffers are in use.
  /// @param index  of the picture, from 1
  /// @param time   by the steady clock
  /// @param write  fills in 640 x 480 grey levels
  void deliver(int index, std::chrono::steady_clock::time_point time,
               const std::function<void(std::span<std::uint8_t>)>& write);
};

}  // namespace octurn
