#pragma once

#include <Driver/OniDriverAPI.h>

#include <atomic>
#include <condition_variable>
#include <mutex>
#include <stop_token>
#include <thread>

#include "simulator/simulated_kinect.hpp"
#include "simulator/simulation.hpp"

namespace octurn {

/// What the device and its stream share: where the platform stands, and whether the device is gone.
struct DeviceState {
  std::atomic<double> angle = 0;  // radians
  std::atomic<bool> is_lost = false;
};

/// The depth stream of a simulated Kinect: DEPTH_100_UM, 640 x 480, 30 frames a second times the
/// simulation's speed, from a thread of its own that runs from start() to stop().
class DepthStream final : public oni::driver::StreamBase {
 public:
  DepthStream(const Simulation& simulation, SimulatedKinect& kinect, DeviceState& device);
  ~DepthStream() override;
  DepthStream(const DepthStream&) = delete;
  DepthStream& operator=(const DepthStream&) = delete;

  static constexpr OniVideoMode video_mode = {ONI_PIXEL_FORMAT_DEPTH_100_UM, 640, 480, 30};

  OniStatus start() override;
  void stop() override;
  OniBool isPropertySupported(int property) override;
  OniStatus getProperty(int property, void* data, int* size) override;
  OniStatus setProperty(int property, const void* data, int size) override;
  void notifyAllProperties() override;

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
