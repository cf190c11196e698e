#include "depth_stream.hpp"

#include <cmath>

#include "property.hpp"

namespace octurn {
namespace {

constexpr int width = DepthStream::video_mode.resolutionX;
constexpr int height = DepthStream::video_mode.resolutionY;
constexpr int row_bytes = width * static_cast<int>(sizeof(OniDepthPixel));
constexpr int nearest = 3000;    // tenths of a millimetre; a reading of 0 stands for 317 mm
constexpr int farthest = 65535;  // no pixel reaches it

float field_of_view(int size, double focal_length) {
  return static_cast<float>(2 * std::atan(size / (2 * focal_length)));
}

std::uint64_t microseconds(std::chrono::steady_clock::time_point time) {
  return static_cast<std::uint64_t>(
      std::chrono::duration_cast<std::chrono::microseconds>(time.time_since_epoch()).count());
}

bool is_our_mode(const OniVideoMode& mode) {
  constexpr OniVideoMode ours = DepthStream::video_mode;
  return mode.pixelFormat == ours.pixelFormat && mode.resolutionX == ours.resolutionX &&
         mode.resolutionY == ours.resolutionY && mode.fps == ours.fps;
}

}  // namespace

void DepthStream::deliver(int index, std::chrono::steady_clock::time_point time,
                          const std::function<void(std::span<OniDepthPixel>)>& write) {
  OniFrame* frame = getServices().acquireFrame();
  if (frame == nullptr) {
    return;
  }
  frame->timestamp = microseconds(time);
  frame->frameIndex = index;
  frame->sensorType = ONI_SENSOR_DEPTH;
  frame->videoMode = video_mode;
  frame->width = width;
  frame->height = height;
  frame->stride = row_bytes;
  frame->croppingEnabled = FALSE;
  frame->cropOriginX = 0;
  frame->cropOriginY = 0;
  frame->dataSize = row_bytes * height;
  write(std::span(static_cast<OniDepthPixel*>(frame->data),
                  static_cast<std::size_t>(width) * height));
  raiseNewFrame(frame);
  getServices().releaseFrame(frame);
}

OniBool DepthStream::isPropertySupported(int property) {
  switch (property) {
    case ONI_STREAM_PROPERTY_VIDEO_MODE:
    case ONI_STREAM_PROPERTY_STRIDE:
    case ONI_STREAM_PROPERTY_HORIZONTAL_FOV:
    case ONI_STREAM_PROPERTY_VERTICAL_FOV:
    case ONI_STREAM_PROPERTY_MIN_VALUE:
    case ONI_STREAM_PROPERTY_MAX_VALUE:
    case ONI_STREAM_PROPERTY_MIRRORING:
      return TRUE;
    default:
      return FALSE;
  }
}

OniStatus DepthStream::getProperty(int property, void* data, int* size) {
  switch (property) {
    case ONI_STREAM_PROPERTY_VIDEO_MODE:
      return give_property(video_mode, data, size);
    case ONI_STREAM_PROPERTY_STRIDE:
      return give_property(row_bytes, data, size);
    case ONI_STREAM_PROPERTY_HORIZONTAL_FOV:
      return give_property(field_of_view(width, focal_length_), data, size);
    case ONI_STREAM_PROPERTY_VERTICAL_FOV:
      return give_property(field_of_view(height, focal_length_), data, size);
    case ONI_STREAM_PROPERTY_MIN_VALUE:
      return give_property(nearest, data, size);
    case ONI_STREAM_PROPERTY_MAX_VALUE:
      return give_property(farthest, data, size);
    case ONI_STREAM_PROPERTY_MIRRORING:
      return give_property(OniBool{FALSE}, data, size);
    case ONI_STREAM_PROPERTY_CROPPING:  // cannot be set, but recordings ask for it
      return give_property(OniCropping{FALSE, 0, 0, width, height}, data, size);
    default:
      return ONI_STATUS_NOT_SUPPORTED;
  }
}

/// The mode and the mirroring can be set to their current values only.
OniStatus DepthStream::setProperty(int property, const void* data, int size) {
  if (property == ONI_STREAM_PROPERTY_VIDEO_MODE) {
    OniVideoMode mode = {};
    const OniStatus status = take_property(mode, data, size);
    return status != ONI_STATUS_OK || is_our_mode(mode) ? status : ONI_STATUS_NOT_SUPPORTED;
  }
  if (property == ONI_STREAM_PROPERTY_MIRRORING) {
    OniBool mirrored = FALSE;
    const OniStatus status = take_property(mirrored, data, size);
    return status != ONI_STATUS_OK || mirrored == FALSE ? status : ONI_STATUS_NOT_SUPPORTED;
  }
  return ONI_STATUS_NOT_SUPPORTED;
}

/// The properties that a recording stores of this stream.
void DepthStream::notifyAllProperties() {
  const float horizontal = field_of_view(width, focal_length_);
  const float vertical = field_of_view(height, focal_length_);
  raisePropertyChanged(ONI_STREAM_PROPERTY_HORIZONTAL_FOV, &horizontal, sizeof horizontal);
  raisePropertyChanged(ONI_STREAM_PROPERTY_VERTICAL_FOV, &vertical, sizeof vertical);
  raisePropertyChanged(ONI_STREAM_PROPERTY_VIDEO_MODE, &video_mode, sizeof video_mode);
  raisePropertyChanged(ONI_STREAM_PROPERTY_MAX_VALUE, &farthest, sizeof farthest);
}

}  // namespace octurn
