#pragma once

#include <Driver/OniDriverAPI.h>

#include <chrono>
#include <functional>
#include <span>

namespace octurn {

/// The depth stream of a Kinect v1, real or simulated: DEPTH_100_UM, 640 x 480, 30 frames a second.
/// It answers OpenNI2's requests and hands over the frames that a derived class produces.
class DepthStream : public oni::driver::StreamBase {
 public:
  /// @param focal_length  of the depth camera, pixels
  explicit DepthStream(double focal_length) : focal_length_(focal_length) {}

  static constexpr OniVideoMode video_mode = {ONI_PIXEL_FORMAT_DEPTH_100_UM, 640, 480, 30};

  OniBool isPropertySupported(int property) override;
  OniStatus getProperty(int property, void* data, int* size) override;
  OniStatus setProperty(int property, const void* data, int size) override;
  void notifyAllProperties() override;

 protected:
  /// Hands a frame to OpenNI2, or drops it if all of OpenNI2's buffers are in use.
  /// @param index  of the frame, from 1
  /// @param time   by the steady clock, which is CLOCK_MONOTONIC here
  /// @param write  fills in 640 x 480 depths
  void deliver(int index, std::chrono::steady_clock::time_point time,
               const std::function<void(std::span<OniDepthPixel>)>& write);

 private:
  double focal_length_;
};

}  // namespace octurn
