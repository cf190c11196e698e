#include "simulator/depth_stream.hpp"

#include <chrono>
#include <cmath>
#include <span>

#include "octurn/intrinsics.hpp"
#include "simulator/property.hpp"

namespace octurn {
namespace {

using std::chrono::steady_clock;

constexpr Intrinsics camera = {};
constexpr int row_bytes = camera.width * static_cast<int>(sizeof(OniDepthPixel));
constexpr int nearest = 4500;    // tenths of a millimetre
constexpr int farthest = 65535;  // no pixel reaches it

float field_of_view(int size, double focal_length) {
  return static_cast<float>(2 * std::atan(size / (2 * focal_length)));
}

/// Microseconds of CLOCK_MONOTONIC, which is what the steady clock is here.
std::uint64_t microseconds(steady_clock::time_point time) {
  return static_cast<std::uint64_t>(
      std::chrono::duration_cast<std::chrono::microseconds>(time.time_since_epoch()).count());
}

bool is_our_mode(const OniVideoMode& mode) {
  constexpr OniVideoMode ours = DepthStream::video_mode;
  return mode.pixelFormat == ours.pixelFormat && mode.resolutionX == ours.resolutionX &&
         mode.resolutionY == ours.resolutionY && mode.fps == ours.fps;
}

}  // namespace

DepthStream::DepthStream(const Simulation& simulation, SimulatedKinect& kinect, DeviceState& device)
    : simulation_(simulation), kinect_(kinect), device_(device) {}

DepthStream::~DepthStream() = default;

OniStatus DepthStream::start() {
  if (!thread_.joinable()) {
    thread_ = std::jthread([this](const std::stop_token& stop) { run(stop); });
  }
  return ONI_STATUS_OK;
}

void DepthStream::stop() { thread_ = {}; }

void DepthStream::run(const std::stop_token& stop) {
  const auto period = std::chrono::duration_cast<steady_clock::duration>(
      std::chrono::duration<double>(1 / (video_mode.fps * simulation_.speed)));
  auto due = steady_clock::now() + period;
  std::unique_lock lock(mutex_);
  for (;;) {
    wake_.wait_until(lock, stop, due, [] { return false; });
    if (stop.stop_requested() || is_out_of_order()) {
      return;
    }
    deliver_frame();
    due = std::max(due + period, steady_clock::now());  // late frames are not made up for
  }
}

/// Whether one of the faults that the simulation asks for has come.
bool DepthStream::is_out_of_order() {
  if (simulation_.lost_after && frames_ >= *simulation_.lost_after) {
    device_.is_lost = true;
  }
  return device_.is_lost || (simulation_.silent_after && frames_ >= *simulation_.silent_after);
}

/// The time is read before the angle, so that a frame stamped after a move shows where it ended.
void DepthStream::deliver_frame() {
  OniFrame* frame = getServices().acquireFrame();
  if (frame == nullptr) {
    return;  // all buffers are in use: this frame is dropped
  }
  frame->timestamp = microseconds(steady_clock::now());
  const double angle = device_.angle;
  ++frames_;
  frame->frameIndex = frames_;
  frame->sensorType = ONI_SENSOR_DEPTH;
  frame->videoMode = video_mode;
  frame->width = camera.width;
  frame->height = camera.height;
  frame->stride = row_bytes;
  frame->croppingEnabled = FALSE;
  frame->cropOriginX = 0;
  frame->cropOriginY = 0;
  frame->dataSize = row_bytes * camera.height;
  kinect_.expose(angle, static_cast<std::uint32_t>(frames_),
                 std::span(static_cast<OniDepthPixel*>(frame->data),
                           static_cast<std::size_t>(camera.width) * camera.height));
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
      return give_property(field_of_view(camera.width, camera.fx), data, size);
    case ONI_STREAM_PROPERTY_VERTICAL_FOV:
      return give_property(field_of_view(camera.height, camera.fy), data, size);
    case ONI_STREAM_PROPERTY_MIN_VALUE:
      return give_property(nearest, data, size);
    case ONI_STREAM_PROPERTY_MAX_VALUE:
      return give_property(farthest, data, size);
    case ONI_STREAM_PROPERTY_MIRRORING:
      return give_property(OniBool{FALSE}, data, size);
    case ONI_STREAM_PROPERTY_CROPPING:  // cannot be set, but recordings ask for it
      return give_property(OniCropping{FALSE, 0, 0, camera.width, camera.height}, data, size);
    default:
      return ONI_STATUS_NOT_SUPPORTED;
  }
}

/// The mode and the mirroring may be set to what they are.
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

/// What a recording keeps of this stream.
void DepthStream::notifyAllProperties() {
  const float horizontal = field_of_view(camera.width, camera.fx);
  const float vertical = field_of_view(camera.height, camera.fy);
  raisePropertyChanged(ONI_STREAM_PROPERTY_HORIZONTAL_FOV, &horizontal, sizeof horizontal);
  raisePropertyChanged(ONI_STREAM_PROPERTY_VERTICAL_FOV, &vertical, sizeof vertical);
  raisePropertyChanged(ONI_STREAM_PROPERTY_VIDEO_MODE, &video_mode, sizeof video_mode);
  raisePropertyChanged(ONI_STREAM_PROPERTY_MAX_VALUE, &farthest, sizeof farthest);
}

}  // namespace octurn
