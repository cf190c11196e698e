#pragma once

#include <atomic>
#include <functional>
#include <mutex>
#include <stop_token>
#include <thread>

#include "rig/simulation.hpp"
#include "sensor_stream.hpp"
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

/// The thread of a simulated stream, from start() to stop(). It takes 30 frames a second times the
/// simulation's speed.
class SimulatorThread {
 public:
  /// @param take  called by the thread for each frame; returns false once the device is lost
  SimulatorThread(const Simulation& simulation, DeviceState& device, std::function<bool()> take);

  OniStatus start();
  void stop() { thread_ = {}; }

 private:
  void run(const std::stop_token& stop);

  const Simulation& simulation_;
  DeviceState& device_;
  std::function<bool()> take_;
  std::jthread thread_ = {};
};

/// The depth stream of a simulated Kinect.
class SimulatorStream final : public DepthStream {
 public:
  SimulatorStream(const Simulation& simulation, SimulatedKinect& kinect, DeviceState& device);

  OniStatus start() override { return thread_.start(); }
  void stop() override { thread_.stop(); }

 private:
  bool take();
  bool is_lost();
  bool is_silent() const;
  void deliver_frame();

  const Simulation& simulation_;
  SimulatedKinect& kinect_;
  DeviceState& device_;
  int frames_ = 0;  // since the device was opened
  SimulatorThread thread_;
};

/// The infrared stream of a simulated Kinect.
class SimulatorInfraredStream final : public InfraredStream {
 public:
  SimulatorInfraredStream(const Simulation& simulation, SimulatedKinect& kinect,
                          DeviceState& device);

  OniStatus start() override { return thread_.start(); }
  void stop() override { thread_.stop(); }

 private:
  bool take();

  SimulatedKinect& kinect_;
  DeviceState& device_;
  int pictures_ = 0;
  SimulatorThread thread_;
};

}  // namespace octurn
