#include "simulator/simulator_stream.hpp"

#include <algorithm>
#include <chrono>
#include <span>
#include <utility>

#include "octurn/snapshot.hpp"
#include "rig/interruptible_sleep.hpp"

namespace octurn {

using std::chrono::steady_clock;

SimulatorThread::SimulatorThread(const Simulation& simulation, DeviceState& device,
                                 std::function<bool()> take)
    : simulation_(simulation), device_(device), take_(std::move(take)) {}

OniStatus SimulatorThread::start() {
  if (!thread_.joinable()) {
    thread_ = std::jthread([this](const std::stop_token& stop) { run(stop); });
  }
  return ONI_STATUS_OK;
}

/// The sensor's clock advances after the frame is sent: a reader of the clock has been sent every
/// frame up to that time.
void SimulatorThread::run(const std::stop_token& stop) {
  const auto period = frame_period(simulation_);
  auto due = steady_clock::now() + period;
  while (sleep_until(stop, due) && take_()) {
    ++device_.periods;
    due = std::max(due + period, steady_clock::now());  // no burst of frames after a delay
  }
}

SimulatorStream::SimulatorStream(const Simulation& simulation, SimulatedKinect& kinect,
                                 DeviceState& device)
    : DepthStream(Intrinsics{}.fx),
      simulation_(simulation),
      kinect_(kinect),
      device_(device),
      thread_(simulation, device, [this] { return take(); }) {}

bool SimulatorStream::take() {
  if (is_lost()) {
    return false;
  }
  if (!is_silent()) {
    deliver_frame();
  }
  return true;
}

bool SimulatorStream::is_lost() {
  if (simulation_.lost_after && frames_ >= *simulation_.lost_after) {
    device_.is_lost = true;
  }
  return device_.is_lost;
}

bool SimulatorStream::is_silent() const {
  return simulation_.silent_after && frames_ >= *simulation_.silent_after;
}

/// The time is read before angle, wall and pose, so that a frame stamped after a move shows the end
/// of it.
void SimulatorStream::deliver_frame() {
  const auto time = steady_clock::now();
  const double angle = device_.angle;
  const std::lock_guard lock(device_.exposing);
  kinect_.turn_to_wall(device_.wall);
  kinect_.show_board(device_.board);
  kinect_.set_object_pose(device_.object_pose);
  ++frames_;
  deliver(frames_, time, [&](std::span<OniDepthPixel> depth) {
    kinect_.expose(angle, static_cast<std::uint32_t>(frames_), depth);
  });
}

SimulatorInfraredStream::SimulatorInfraredStream(const Simulation& simulation,
                                                 SimulatedKinect& kinect, DeviceState& device)
    : kinect_(kinect), device_(device), thread_(simulation, device, [this] { return take(); }) {}

bool SimulatorInfraredStream::take() {
  if (device_.is_lost) {
    return false;
  }
  const auto time = steady_clock::now();
  const std::lock_guard lock(device_.exposing);
  kinect_.show_board(device_.board);
  ++pictures_;
  deliver(pictures_, time, [&](std::span<std::uint8_t> picture) {
    kinect_.expose_infrared(static_cast<std::uint32_t>(pictures_), picture);
  });
  return true;
}

}  // namespace octurn
