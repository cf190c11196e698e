#include "kinect/kinect_stream.hpp"

#include <algorithm>

#include "rig/kinect_device.hpp"

namespace octurn {

KinectStream::KinectStream(Kinect& kinect)
    : DepthStream(kinect.parameters().focal_length()),
      kinect_(kinect),
      table_(depth_table(kinect.parameters())) {}

KinectStream::~KinectStream() = default;

OniStatus KinectStream::start() {
  if (!thread_.joinable()) {
    thread_ = std::jthread([this](const std::stop_token& stop) {
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
