#include "infrared_stream.hpp"

#include <cstddef>

#include "property.hpp"

namespace octurn {
namespace {

constexpr int width = InfraredStream::video_mode.resolutionX;
constexpr int height = InfraredStream::video_mode.resolutionY;

}  // namespace

OniBool InfraredStream::isPropertySupported(int property) {
  return property == ONI_STREAM_PROPERTY_VIDEO_MODE || property == ONI_STREAM_PROPERTY_STRIDE ||
                 property == ONI_STREAM_PROPERTY_MIRRORING
             ? TRUE
             : FALSE;
}

OniStatus InfraredStream::getProperty(int property, void* data, int* size) {
  switch (property) {
    case ONI_STREAM_PROPERTY_VIDEO_MODE:
      return give_property(video_mode, data, size);
    case ONI_STREAM_PROPERTY_STRIDE:
      return give_property(width, data, size);
    case ONI_STREAM_PROPERTY_MIRRORING:
      return give_property(OniBool{FALSE}, data, size);
    case ONI_STREAM_PROPERTY_CROPPING:
      return give_property(OniCropping{FALSE, 0, 0, width, height}, data, size);
    default:
      return ONI_STATUS_NOT_SUPPORTED;
  }
}

/// The mode and the mirroring can be set to their current values only.
OniStatus InfraredStream::setProperty(int property, const void* data, int size) {
  if (property == ONI_STREAM_PROPERTY_VIDEO_MODE) {
    OniVideoMode mode = {};
    const OniStatus status = take_property(mode, data, size);
    const bool is_ours = mode.pixelFormat == video_mode.pixelFormat && mode.resolutionX == width &&
                         mode.resolutionY == height && mode.fps == video_mode.fps;
    return status != ONI_STATUS_OK || is_ours ? status : ONI_STATUS_NOT_SUPPORTED;
  }
  if (property == ONI_STREAM_PROPERTY_MIRRORING) {
    OniBool mirrored = FALSE;
    const OniStatus status = take_property(mirrored, data, size);
    return status != ONI_STATUS_OK || mirrored == FALSE ? status : ONI_STATUS_NOT_SUPPORTED;
  }
  return ONI_STATUS_NOT_SUPPORTED;
}

void InfraredStream::deliver(int index, std::chrono::steady_clock::time_point time,
                             const std::function<void(std::span<std::uint8_t>)>& write) {
  OniFrame* frame = getServices().acquireFrame();
  if (frame == nullptr) {
    return;
  }
  frame->timestamp = static_cast<std::uint64_t>(
      std::chrono::duration_cast<std::chrono::microseconds>(time.time_since_epoch()).count());
  frame->frameIndex = index;
  frame->sensorType = ONI_SENSOR_IR;
  frame->videoMode = video_mode;
  frame->width = width;
  frame->height = height;
  frame->stride = width;
  frame->croppingEnabled = FALSE;
  frame->cropOriginX = 0;
  frame->cropOriginY = 0;
  frame->dataSize = width * height;
  write(
      std::span(static_cast<std::uint8_t*>(frame->data), static_cast<std::size_t>(width) * height));
  raiseNewFrame(frame);
  getServices().releaseFrame(frame);
}

}  // namespace octurn
