#include "kinect/kinect_stream.hpp"

#include <pthread.h>
#include <sched.h>

#include <algorithm>
#include <utility>

#include "rig/kinect_device.hpp"

namespace octurn {
namespace {

/// Without the permission this thread stays an ordinary one: `octurn doctor` says so.
void ask_for_priority() {
  const sched_param parameters{.sched_priority = usb_thread_priority};
  ::pthread_setschedparam(::pthread_self(), SCHED_FIFO, &parameters);
}

std::uint8_t to_grey(std::uint16_t reading) {
  const int grey = reading >> (infrared_packets.reading_bits - 8);
  return reading == lost_reading ? lost_infrared
                                 : static_cast<std::uint8_t>(std::max(grey, lost_infrared + 1));
}

}  // namespace

KinectThread::KinectThread(Kinect& kinect, oni::driver::DriverServices& services,
                           const CameraStream& stream,
                           std::function<void(const RawFrame&)> on_frame)
    : kinect_(kinect), services_(services), stream_(stream), on_frame_(std::move(on_frame)) {}

OniStatus KinectThread::start() {
  if (thread_.joinable()) {
    return ONI_STATUS_OK;
  }
  Kinect::Use use = kinect_.use();
  if (!use) {
    services_.errorLoggerAppend("kinect: its other stream runs, and it has one at a time");
    return ONI_STATUS_ERROR;
  }
  thread_ = std::jthread([this, use = std::move(use)](const std::stop_token& stop) mutable {
    ask_for_priority();
    kinect_.stream(std::move(use), stream_, stop, on_frame_);
  });
  return ONI_STATUS_OK;
}

KinectDepthStream::KinectDepthStream(Kinect& kinect, oni::driver::DriverServices& services)
    : DepthStream(kinect.parameters().focal_length()),
      table_(depth_table(kinect.parameters())),
      thread_(kinect, services, depth_camera, [this](const RawFrame& frame) { convert(frame); }) {}

void KinectDepthStream::convert(const RawFrame& frame) {
  deliver(++frames_, frame.time, [&](std::span<OniDepthPixel> depth) {
    std::ranges::transform(frame.readings, depth.begin(), [this](std::uint16_t reading) {
      return reading == lost_reading ? lost_depth : table_[reading];
    });
  });
}

KinectInfraredStream::KinectInfraredStream(Kinect& kinect, oni::driver::DriverServices& services)
    : thread_(kinect, services, infrared_camera,
              [this](const RawFrame& frame) { convert(frame); }) {}

void KinectInfraredStream::convert(const RawFrame& frame) {
  deliver(++frames_, frame.time, [&](std::span<std::uint8_t> picture) {
    std::ranges::transform(frame.readings.first(picture.size()), picture.begin(), to_grey);
  });
}

}  // namespace octurn
