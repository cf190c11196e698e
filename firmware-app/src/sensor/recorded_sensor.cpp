#include <array>
#include <charconv>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>

#include "octurn/error.hpp"
#include "octurn/units.hpp"
#include "sensor/depth_sensor.hpp"
#include "sensor/frame_limiter.hpp"
#include "sensor/recording.hpp"

namespace octurn {
namespace {

/// An angle as people write it: "45", "9.73".
std::string to_degrees_text(double angle) {
  std::array<char, 32> digits{};
  const auto end = std::to_chars(digits.data(), digits.data() + digits.size(),
                                 std::round(degrees_from_radians(angle) * 100) / 100)
                       .ptr;
  return {digits.data(), end};
}

/// Whether two angles of the platform are equal up to rounding in a file.
bool is_same_angle(double one, double other) {
  constexpr double close = 1e-7;  // radians; the finest step of a turntable is 4e-7
  return std::abs(std::remainder(one - other, 2 * std::numbers::pi)) < close;
}

/// Plays the frames that were recorded at the platform's angle, in order and in a loop.
class RecordedSensor final : public DepthSensor {
 public:
  explicit RecordedSensor(std::filesystem::path folder)
      : folder_(std::move(folder)),
        recording_(read_recording(folder_)),
        name_(recording_.sensor_name + " (recorded)"),
        angle_(recording_.frames.front().angle) {}

  const std::string& name() const override { return name_; }
  const Intrinsics& intrinsics() const override { return recording_.intrinsics; }
  std::string serial() const override { return recording_.sensor_serial; }

  std::optional<TimedFrame> read(const std::stop_token& stop) override {
    const std::size_t frame = next_frame();
    if (!limiter_.wait(stop)) {
      return std::nullopt;
    }
    tilt_ = recording_.frames[frame].tilt;
    next_ = frame + 1;
    return TimedFrame{.frame = read_recorded_frame(folder_, recording_, frame),
                      .time = std::chrono::steady_clock::now()};
  }

  std::optional<Tilt> tilt() const override { return tilt_; }

  std::optional<PacketCounts> packet_counts() const override { return std::nullopt; }

  void show_angle(double angle) override {
    angle_ = angle;
    next_ = 0;
  }

 private:
  /// Index of the next frame that was taken at the platform's angle.
  std::size_t next_frame() const {
    const std::size_t count = recording_.frames.size();
    for (std::size_t i = 0; i < count; ++i) {
      const std::size_t frame = (next_ + i) % count;
      if (is_same_angle(recording_.frames[frame].angle, angle_)) {
        return frame;
      }
    }
    throw Error(ErrorCode::sensor_failed,
                "the recording has no frame at " + to_degrees_text(angle_) + " degrees",
                "Scan with as many snapshots as were recorded.");
  }

  std::filesystem::path folder_;
  Recording recording_;
  std::string name_;
  double angle_;
  std::size_t next_ = 0;
  std::optional<Tilt> tilt_ = recording_.frames.front().tilt;
  FrameLimiter limiter_ = {};
};

}  // namespace

std::unique_ptr<DepthSensor> open_recording(const std::string& folder) {
  return std::make_unique<RecordedSensor>(folder);
}

}  // namespace octurn
