#pragma once

#include <atomic>
#include <condition_variable>
#include <mutex>
#include <stop_token>
#include <thread>

#include "depth_stream.hpp"
#include "simulator/simulated_kinect.hpp"
#include "simulator/simulation.hpp"

namespace octurn {

/// What the device and its stream share: where the platform stands, and whether the device is gone.
struct DeviceState {
  std::atomic<double> angle = 0;  // radians
  std::atomic<bool> is_lost = false;
};

/// The depth stream of a simulated Kinect, at 30 frames a second times the simulation's speed, from
/// a thread of its own that runs from start() to stop().
class SimulatorStream final : public DepthStream {
 public:
  SimulatorStream(const Simulation& simulation, SimulatedKinect& kinect, DeviceState& device);
  ~SimulatorStream() override;
  SimulatorStream(const SimulatorStream&) = delete;
  SimulatorStream& operator=(const SimulatorStream&) = delete;

  OniStatus start() override;
  void stop() override;

 private:
  void run(const std::stop_token& stop);
  bool is_out_of_order();
  void deliver_frame();

  const Simulation& simulation_;
  SimulatedKinect& kinect_;
  DeviceState& device_;
  int frames_ = 0;    // since the device was opened
  std::mutex mutex_;  // guards nothing: what the condition needs to wait
  std::condition_variable_any wake_;
  std::jthread thread_;
};

}  // namespace octurn
