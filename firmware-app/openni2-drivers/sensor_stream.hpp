#pragma once

#include <Driver/OniDriverAPI.h>

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>

namespace octurn {

/// A stream of one mode. It answers OpenNI2's requests and hands over the frames that a derived
/// class produces.
class SensorStream : public oni::driver::StreamBase {
 public:
  OniBool isPropertySupported(int property) override;
  OniStatus getProperty(int property, void* data, int* size) override;

  /// The mode and the mirroring can be set to their current values only.
  OniStatus setProperty(int property, const void* data, int size) override;

 protected:
  /// @param pixel_bytes  of the mode's format
  SensorStream(OniSensorType sensor, const OniVideoMode& mode, int pixel_bytes)
      : sensor_(sensor), mode_(mode), row_bytes_(mode.resolutionX * pixel_bytes) {}

  /// Hands a frame to OpenNI2, or drops it if all of OpenNI2's buffers are in use.
  /// @param index  of the frame, from 1
  /// @param time   by the steady clock, which is CLOCK_MONOTONIC here
  /// @param write  fills in the pixels, row by row
  template <typename Pixel>
  void deliver_pixels(int index, std::chrono::steady_clock::time_point time,
                      const std::function<void(std::span<Pixel>)>& write) {
    if (OniFrame* const frame = new_frame(index, time)) {
      write(std::span(
          static_cast<Pixel*>(frame->data),
          static_cast<std::size_t>(frame->width) * static_cast<std::size_t>(frame->height)));
      send(frame);
    }
  }

 private:
  OniFrame* new_frame(int index, std::chrono::steady_clock::time_point time);
  void send(OniFrame* frame);

  OniSensorType sensor_;
  OniVideoMode mode_;
  int row_bytes_;
};

/// The depth stream of a Kinect v1, real or simulated: DEPTH_100_UM, 640 x 480, 30 frames a second.
class DepthStream : public SensorStream {
 public:
  static constexpr OniVideoMode video_mode = {ONI_PIXEL_FORMAT_DEPTH_100_UM, 640, 480, 30};

  /// @param focal_length  of the depth camera, pixels
  explicit DepthStream(double focal_length)
      : SensorStream(ONI_SENSOR_DEPTH, video_mode, sizeof(OniDepthPixel)),
        focal_length_(focal_length) {}

  OniBool isPropertySupported(int property) override;
  OniStatus getProperty(int property, void* data, int* size) override;
  void notifyAllProperties() override;

 protected:
  /// As `deliver_pixels`.
  void deliver(int index, std::chrono::steady_clock::time_point time,
               const std::function<void(std::span<OniDepthPixel>)>& write) {
    deliver_pixels(index, time, write);
  }

 private:
  double focal_length_;
};

/// The infrared stream of a Kinect v1, real or simulated: GRAY8, 640 x 480, 30 frames a second, as
/// the camera sees the room and its projector's dots.
class InfraredStream : public SensorStream {
 public:
  static constexpr OniVideoMode video_mode = {ONI_PIXEL_FORMAT_GRAY8, 640, 480, 30};

  InfraredStream() : SensorStream(ONI_SENSOR_IR, video_mode, sizeof(std::uint8_t)) {}

 protected:
  /// As `deliver_pixels`.
  void deliver(int index, std::chrono::steady_clock::time_point time,
               const std::function<void(std::span<std::uint8_t>)>& write) {
    deliver_pixels(index, time, write);
  }
};

}  // namespace octurn
