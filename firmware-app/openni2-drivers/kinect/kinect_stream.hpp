#pragma once

#include <stop_token>
#include <thread>

#include "depth_stream.hpp"
#include "kinect/kinect.hpp"

namespace octurn {

/// The depth stream of a Kinect, from a thread of its own that runs from start() to stop().
class KinectStream final : public DepthStream {
 public:
  explicit KinectStream(Kinect& kinect);
  ~KinectStream() override;
  KinectStream(const KinectStream&) = delete;
  KinectStream& operator=(const KinectStream&) = delete;

  OniStatus start() override;
  void stop() override;

 private:
  void convert(const RawFrame& frame);

  Kinect& kinect_;
  DepthTable table_;
  int frames_ = 0;
  std::jthread thread_;
};

}  // namespace octurn
