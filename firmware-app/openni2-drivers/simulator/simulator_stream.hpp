#pragma once

#include <atomic>
#include <mutex>
#include <stop_token>
#include <thread>

#include "depth_stream.hpp"
#include "infrared_stream.hpp"
#include "rig/simulation.hpp"
#include "simulator/simulated_kinect.hpp"

namespace octurn {

/// The state that a simulated device shares with its stream.
struct DeviceState {
  std::atomic<double> angle = 0;     // of the platform, radians
  std::atomic<double> wall = 0;      // metres to the wall that the sensor faces; 0: none
  std::atomic<int> object_pose = 0;  // number of the object's pose
  std::atomic<int> board = 0;        // number of the hold of a printed board; 0: none
  std::mutex exposing = {};          // guards the simulated Kinect: a stream at a time
  std::atomic<int> periods = 0;      // frame periods since the device was opened
  std::atomic<bool> is_lost = false;
};

/// The depth stream of a simulated Kinect, at 30 frames a second times the simulation's speed. Its
/// own thread renders from start() to stop().
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
  bool is_lost();
  bool is_silent() const;
  void deliver_frame();

  const Simulation& simulation_;
  SimulatedKinect& kinect_;
  DeviceState& device_;
  int frames_ = 0;  // since the device was opened
  std::jthread thread_;
};

/// The infrared stream of a simulated Kinect, likewise.
class SimulatorInfraredStream final : public InfraredStream {
 public:
  SimulatorInfraredStream(const Simulation& simulation, SimulatedKinect& kinect,
                          DeviceState& device)
      : simulation_(simulation), kinect_(kinect), device_(device) {}

  OniStatus start() override;
  void stop() override { thread_ = {}; }

 private:
  void run(const std::stop_token& stop);

  const Simulation& simulation_;
  SimulatedKinect& kinect_;
  DeviceState& device_;
  int pictures_ = 0;
  std::jthread thread_;
};

}  // namespace octurn
