#include "kinect/kinect_stream.hpp"

#include <pthread.h>
#include <sched.h>

#include <algorithm>

#include "rig/kinect_device.hpp"

namespace octurn {
namespace {

/// Without the permission this thread stays an ordinary one: `octurn doctor` says so.
void ask_for_priority() {
  const sched_param parameters{.sched_priority = usb_thread_priority};
  ::pthread_setschedparam(::pthread_self(), SCHED_FIFO, &parameters);
}

}  // namespace

KinectStream::KinectStream(Kinect& kinect)
    : DepthStream(kinect.parameters().focal_length()),
      kinect_(kinect),
      table_(depth_table(kinect.parameters())) {}

KinectStream::~KinectStream() = default;

OniStatus KinectStream::start() {
  if (!thread_.joinable()) {
    thread_ = std::jthread([this](const std::stop_token& stop) {
      ask_for_priority();
      kinect_.stream(stop, [this](const RawFrame& frame) { convert(frame); });
    });
  }
  return ONI_STATUS_OK;
}

void KinectStream::stop() { thread_ = {}; }

void KinectStream::convert(const RawFrame& frame) {
  deliver(++frames_, frame.time, [&](std::span<OniDepthPixel> depth) {
    std::ranges::transform(frame.readings, depth.begin(), [this](std::uint16_t reading) {
      return reading == lost_reading ? lost_depth : table_[reading];
    });
  });
}

}  // namespace octurn
