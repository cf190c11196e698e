#include <OpenNI.h>

#include <chrono>
#include <string>

#include "octurn/error.hpp"
#include "sensor/depth_sensor.hpp"
#include "sensor/frame_limiter.hpp"
#include "sensor/openni_library.hpp"

namespace octurn {
namespace {

/// A frame's timeout: OpenNI2's player may hang.
constexpr std::chrono::milliseconds longest_read = std::chrono::seconds(30);

/// Plays a recording of OpenNI2's recorder frame by frame, in a loop.
class OniFile final : public DepthSensor {
 public:
  explicit OniFile(const std::string& path) {
    load_sensor_drivers();
    open(path);
    intrinsics_ = to_intrinsics(stream_);
    name_ = device_.getDeviceInfo().getName();
  }

  const std::string& name() const override { return name_; }
  const Intrinsics& intrinsics() const override { return intrinsics_; }
  std::string serial() const override { return {}; }
  std::optional<TimedFrame> read(const std::stop_token& stop) override;
  std::optional<Tilt> tilt() const override { return std::nullopt; }
  std::optional<PacketCounts> packet_counts() const override { return std::nullopt; }
  void show_angle(double /*angle*/) override {}

 private:
  void open(const std::string& path);

  openni::Device device_ = {};
  openni::VideoStream stream_ = {};
  Intrinsics intrinsics_ = {};
  std::string name_ = {};
  FrameLimiter limiter_ = {};
};

/// Makes OpenNI2 read each frame on demand and skip none, and begin again after the last one.
///
/// The thread of OpenNI2 2.2.0.33's player iterates over its streams without a lock while another
/// thread may destroy one. A player that repeats its file waits between two frames. At the end of a
/// file that is not repeated it only iterates, and destroying the stream then crashes.
void OniFile::open(const std::string& path) {
  open_device(device_, path);
  expect_ok(stream_.create(device_, openni::SENSOR_DEPTH), "find its depth stream");
  openni::PlaybackControl* playback = device_.getPlaybackControl();
  expect_ok(playback->setSpeed(-1), "read it frame by frame");
  expect_ok(playback->setRepeatEnabled(true), "begin it again");
  if (playback->getNumberOfFrames(stream_) <= 0) {
    throw Error(ErrorCode::sensor_failed, path + ": has no depth frame");
  }
  if (stream_.getMirroringEnabled()) {
    throw Error(ErrorCode::sensor_failed, path + ": its frames are mirrored",
                "Record it again without mirroring.");
  }
  expect_ok(stream_.start(), "start its depth stream");
}

/// Each wait makes the player read the next frame, so a frame is waited for once: a second wait
/// would skip it.
std::optional<TimedFrame> OniFile::read(const std::stop_token& stop) {
  if (!limiter_.wait(stop)) {
    return std::nullopt;
  }
  if (!wait_for_frame(stream_, longest_read)) {
    throw silence_error(longest_read);
  }
  return TimedFrame{.frame = to_depth_frame(read_frame(stream_)),
                    .time = std::chrono::steady_clock::now()};
}

}  // namespace

std::unique_ptr<DepthSensor> open_oni_file(const std::string& path) {
  return std::make_unique<OniFile>(path);
}

}  // namespace octurn
