#include "simulator/simulator_stream.hpp"

#include <algorithm>
#include <chrono>
#include <span>

#include "octurn/depth_frame.hpp"

namespace octurn {

using std::chrono::steady_clock;

SimulatorStream::SimulatorStream(const Simulation& simulation, SimulatedKinect& kinect,
                                 DeviceState& device)
    : DepthStream(Intrinsics{}.fx), simulation_(simulation), kinect_(kinect), device_(device) {}

SimulatorStream::~SimulatorStream() = default;

OniStatus SimulatorStream::start() {
  if (!thread_.joinable()) {
    thread_ = std::jthread([this](const std::stop_token& stop) { run(stop); });
  }
  return ONI_STATUS_OK;
}

void SimulatorStream::stop() { thread_ = {}; }

void SimulatorStream::run(const std::stop_token& stop) {
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
bool SimulatorStream::is_out_of_order() {
  if (simulation_.lost_after && frames_ >= *simulation_.lost_after) {
    device_.is_lost = true;
  }
  return device_.is_lost || (simulation_.silent_after && frames_ >= *simulation_.silent_after);
}

/// The time is read before the angle, so that a frame stamped after a move shows where it ended.
void SimulatorStream::deliver_frame() {
  const auto time = steady_clock::now();
  const double angle = device_.angle;
  ++frames_;
  deliver(frames_, time, [&](std::span<OniDepthPixel> depth) {
    kinect_.expose(angle, static_cast<std::uint32_t>(frames_), depth);
  });
}

}  // namespace octurn
