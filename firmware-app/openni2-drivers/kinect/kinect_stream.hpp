#pragma once

#include <functional>
#include <stop_token>
#include <thread>

#include "depth_driver.hpp"
#include "kinect/kinect.hpp"

namespace octurn {

/// A stream of a Kinect, in a thread of its own that runs from start() to stop().
class KinectThread {
 public:
  /// @param on_frame  called by the thread
  KinectThread(Kinect& kinect, oni::driver::DriverServices& services, const CameraStream& stream,
               std::function<void(const RawFrame&)> on_frame);

  /// @return ONI_STATUS_ERROR if another stream of this Kinect runs; OpenNI2's log says so
  OniStatus start();
  void stop() { thread_ = {}; }

 private:
  Kinect& kinect_;
  oni::driver::DriverServices& services_;
  const CameraStream& stream_;
  std::function<void(const RawFrame&)> on_frame_;
  std::jthread thread_ = {};
};

/// The depth stream of a Kinect.
class KinectDepthStream final : public DepthStream {
 public:
  KinectDepthStream(Kinect& kinect, oni::driver::DriverServices& services);

  OniStatus start() override { return thread_.start(); }
  void stop() override { thread_.stop(); }

 private:
  void convert(const RawFrame& frame);

  DepthTable table_;
  int frames_ = 0;
  KinectThread thread_;
};

/// The infrared stream of a Kinect: the upper eight bits of its readings, but `lost_infrared` where
/// they were lost. The camera's last eight rows are left out, as PrimeSense's driver does.
class KinectInfraredStream final : public InfraredStream {
 public:
  KinectInfraredStream(Kinect& kinect, oni::driver::DriverServices& services);

  OniStatus start() override { return thread_.start(); }
  void stop() override { thread_.stop(); }

 private:
  void convert(const RawFrame& frame);

  int frames_ = 0;
  KinectThread thread_;
};

}  // namespace octurn
