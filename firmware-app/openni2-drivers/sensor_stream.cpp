#include "sensor_stream.hpp"

#include <cmath>

#include "property.hpp"

namespace octurn {
namespace {

constexpr int nearest = 3000;    // tenths of a millimetre; a reading of 0 stands for 317 mm
constexpr int farthest = 65535;  // no pixel reaches it

float field_of_view(int size, double focal_length) {
  return static_cast<float>(2 * std::atan(size / (2 * focal_length)));
}

std::uint64_t microseconds(std::chrono::steady_clock::time_point time) {
  return static_cast<std::uint64_t>(
      std::chrono::duration_cast<std::chrono::microseconds>(time.time_since_epoch()).count());
}

bool is_same(const OniVideoMode& mode, const OniVideoMode& other) {
  return mode.pixelFormat == other.pixelFormat && mode.resolutionX == other.resolutionX &&
         mode.resolutionY == other.resolutionY && mode.fps == other.fps;
}

}  // namespace

OniFrame* SensorStream::new_frame(int index, std::chrono::steady_clock::time_point time) {
  OniFrame* const frame = getServices().acquireFrame();
  if (frame == nullptr) {
    return nullptr;
  }
  frame->timestamp = microseconds(time);
  frame->frameIndex = index;
  frame->sensorType = sensor_;
  frame->videoMode = mode_;
  frame->width = mode_.resolutionX;
  frame->height = mode_.resolutionY;
  frame->stride = row_bytes_;
  frame->croppingEnabled = FALSE;
  frame->cropOriginX = 0;
  frame->cropOriginY = 0;
  frame->dataSize = row_bytes_ * mode_.resolutionY;
  return frame;
}

void SensorStream::send(OniFrame* frame) {
  raiseNewFrame(frame);
  getServices().releaseFrame(frame);
}

OniBool SensorStream::isPropertySupported(int property) {
  return property == ONI_STREAM_PROPERTY_VIDEO_MODE || property == ONI_STREAM_PROPERTY_STRIDE ||
                 property == ONI_STREAM_PROPERTY_MIRRORING
             ? TRUE
             : FALSE;
}

OniStatus SensorStream::getProperty(int property, void* data, int* size) {
  switch (property) {
    case ONI_STREAM_PROPERTY_VIDEO_MODE:
      return give_property(mode_, data, size);
    case ONI_STREAM_PROPERTY_STRIDE:
      return give_property(row_bytes_, data, size);
    case ONI_STREAM_PROPERTY_MIRRORING:
      return give_property(OniBool{FALSE}, data, size);
    case ONI_STREAM_PROPERTY_CROPPING:  // cannot be set, but recordings ask for it
      return give_property(OniCropping{FALSE, 0, 0, mode_.resolutionX, mode_.resolutionY}, data,
                           size);
    default:
      return ONI_STATUS_NOT_SUPPORTED;
  }
}

OniStatus SensorStream::setProperty(int property, const void* data, int size) {
  if (property == ONI_STREAM_PROPERTY_VIDEO_MODE) {
    OniVideoMode mode = {};
    const OniStatus status = take_property(mode, data, size);
    return status != ONI_STATUS_OK || is_same(mode, mode_) ? status : ONI_STATUS_NOT_SUPPORTED;
  }
  if (property == ONI_STREAM_PROPERTY_MIRRORING) {
    OniBool mirrored = FALSE;
    const OniStatus status = take_property(mirrored, data, size);
    return status != ONI_STATUS_OK || mirrored == FALSE ? status : ONI_STATUS_NOT_SUPPORTED;
  }
  return ONI_STATUS_NOT_SUPPORTED;
}

OniBool DepthStream::isPropertySupported(int property) {
  switch (property) {
    case ONI_STREAM_PROPERTY_HORIZONTAL_FOV:
    case ONI_STREAM_PROPERTY_VERTICAL_FOV:
    case ONI_STREAM_PROPERTY_MIN_VALUE:
    case ONI_STREAM_PROPERTY_MAX_VALUE:
      return TRUE;
    default:
      return SensorStream::isPropertySupported(property);
  }
}

OniStatus DepthStream::getProperty(int property, void* data, int* size) {
  switch (property) {
    case ONI_STREAM_PROPERTY_HORIZONTAL_FOV:
      return give_property(field_of_view(video_mode.resolutionX, focal_length_), data, size);
    case ONI_STREAM_PROPERTY_VERTICAL_FOV:
      return give_property(field_of_view(video_mode.resolutionY, focal_length_), data, size);
    case ONI_STREAM_PROPERTY_MIN_VALUE:
      return give_property(nearest, data, size);
    case ONI_STREAM_PROPERTY_MAX_VALUE:
      return give_property(farthest, data, size);
    default:
      return SensorStream::getProperty(property, data, size);
  }
}

/// The properties that a recording stores of this stream.
void DepthStream::notifyAllProperties() {
  const float horizontal = field_of_view(video_mode.resolutionX, focal_length_);
  const float vertical = field_of_view(video_mode.resolutionY, focal_length_);
  raisePropertyChanged(ONI_STREAM_PROPERTY_HORIZONTAL_FOV, &horizontal, sizeof horizontal);
  raisePropertyChanged(ONI_STREAM_PROPERTY_VERTICAL_FOV, &vertical, sizeof vertical);
  raisePropertyChanged(ONI_STREAM_PROPERTY_VIDEO_MODE, &video_mode, sizeof video_mode);
  raisePropertyChanged(ONI_STREAM_PROPERTY_MAX_VALUE, &farthest, sizeof farthest);
}

}  // namespace octurn
