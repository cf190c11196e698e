// Scans over wires that lose packets, beside one over a wire that is well: the same object, noise,
// stops and settings. Time is counted in frames that the sensor sent.
//
//   emulation_tests --gtest_filter='*KinectAccuracy.*' --gtest_output=xml:FILE  writes the figures.

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <deque>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "capture/rig.hpp"
#include "kinect/depth_table.hpp"
#include "kinect/emulated/camera.hpp"
#include "kinect/kinect_view.hpp"
#include "kinect/lossy_wire.hpp"
#include "kinect/packet_frames.hpp"
#include "octurn/units.hpp"
#include "run/run_scan.hpp"
#include "simulator/camera.hpp"
#include "simulator/simulated_kinect.hpp"
#include "simulator/simulator_object.hpp"

namespace octurn {
namespace {

using std::chrono::steady_clock;

/// A simulated Kinect whose frames come in packets, put together again by the driver's own code.
class WireSensor final : public DepthSensor {
 public:
  WireSensor(const LossyWire& wire, int& sent) : sent_(sent) {
    emulated_.random_loss = wire.random_loss;
    emulated_.burst = wire.burst;
    emulated_.depth_on = true;
    show_angle(0);
  }

  const std::string& name() const override { return name_; }
  const Intrinsics& intrinsics() const override { return camera; }
  std::string serial() const override { return {}; }
  std::optional<Tilt> tilt() const override { return std::nullopt; }
  std::optional<PacketCounts> packet_counts() const override { return std::nullopt; }

  std::optional<TimedFrame> read(const std::stop_token& stop) override {
    while (arrived_.empty() && !stop.stop_requested()) {
      send_frame();
    }
    if (arrived_.empty()) {
      return std::nullopt;
    }
    TimedFrame frame = std::move(arrived_.front());
    arrived_.pop_front();
    return frame;
  }

  /// What was sent before is from before the platform turned.
  void show_angle(double angle) override {
    angle_ = angle;
    arrived_.clear();
    frames_.emplace(depth_packets, [this](const ReceivedFrame& frame) { take(frame); });
  }

 private:
  std::span<const std::uint16_t> exposed() {
    DepthFrame seen{
        .width = 640, .height = 480, .depth = std::vector<std::uint16_t>(EmulatedCamera::pixels)};
    kinect_.expose(angle_, static_cast<std::uint32_t>(sent_++), seen.depth);
    readings_ = readings_of(seen);
    return readings_;
  }

  void send_frame() {
    std::array<std::uint8_t, 1920> packet = {};
    for (int i = 0; i < EmulatedCamera::microframes_in_frame; ++i) {
      const int bytes = camera_.next_packet(packet);
      frames_->take(std::span(packet).first(static_cast<std::size_t>(bytes)), steady_clock::now());
    }
  }

  void take(const ReceivedFrame& frame) {
    if (5 * std::ssize(frame.lost) > depth_packets.packets()) {
      return;
    }
    std::vector<std::uint16_t> readings(EmulatedCamera::pixels);
    unpack_readings(frame, depth_packets, readings);
    TimedFrame timed{.frame = {.width = 640,
                               .height = 480,
                               .depth = std::vector<std::uint16_t>(EmulatedCamera::pixels)},
                     .time = steady_clock::now()};
    for (std::size_t i = 0; i < readings.size(); ++i) {
      if (readings[i] == lost_reading) {
        timed.lost.push_back(i);
      } else {
        timed.frame.depth[i] = table_[readings[i]];
      }
    }
    arrived_.push_back(std::move(timed));
  }

  std::string name_ = "Kinect on a wire";
  int& sent_;
  double angle_ = 0;
  SimulatedKinect kinect_{Scene(simulator_object()), 1, 1, 0};
  Readings readings_ = {};
  EmulatedKinect emulated_;
  EmulatedCamera camera_{emulated_, [this](int) { return exposed(); }};
  DepthTable table_ = depth_table({});
  std::optional<PacketFrames> frames_ = {};
  std::deque<TimedFrame> arrived_ = {};
};

/// The mean distance of a model's corners from the object, by first order (Taubin 1991), mm.
double mean_error_mm(const std::string& stl) {
  constexpr std::size_t first = 84 + 12;  // after the file's header and a normal
  constexpr double h = 1e-5;              // metres
  double sum = 0;
  int corners = 0;
  for (std::size_t at = first; at + 38 <= stl.size(); at += 50) {
    for (std::size_t corner = 0; corner < 3; ++corner) {
      Eigen::Vector3f mm;
      std::memcpy(mm.data(), &stl[at + corner * sizeof mm], sizeof mm);
      const Eigen::Vector3d point = mm.cast<double>().unaryExpr(&metres_from_mm);
      Eigen::Vector3d slope;
      for (int axis = 0; axis < 3; ++axis) {
        const Eigen::Vector3d step = h * Eigen::Vector3d::Unit(axis);
        slope[axis] =
            (simulator_object_distance(point + step) - simulator_object_distance(point - step)) /
            (2 * h);
      }
      sum += std::abs(simulator_object_distance(point)) / std::max(slope.norm(), 0.1);
      ++corners;
    }
  }
  return corners > 0 ? mm_from_metres(sum / corners) : 0;
}

struct Outcome {
  double error_mm = 0;
  int frames = 0;  // sent until the scan's end
  Verdict verdict = Verdict::bad;
};

Outcome scan(const LossyWire& wire) {
  const TemporaryFolder folder;
  int sent = 0;
  Rig rig({.speed = 100, .open_sensor = [&](const std::string&) {
             return std::make_unique<WireSensor>(wire, sent);
           }});
  const ScanSettings settings{.snapshots = 8, .leaf_size = 0.002, .pose = PoseSource::configured};
  const auto model = run_scan(settings, {}, folder.path(), *make_capture(rig), {}, {});
  return {.error_mm = mean_error_mm(content_of(folder.path() / "Scan.stl")),
          .frames = sent,
          .verdict = model.value().quality.value().verdict};
}

class KinectAccuracy : public ::testing::TestWithParam<LossyWire> {};

TEST_P(KinectAccuracy, IsThatOfAWireThatIsWell) {
  static const Outcome whole = scan({});
  const Outcome lossy = scan(GetParam());
  RecordProperty("error_without_loss_um", static_cast<int>(std::lround(1000 * whole.error_mm)));
  RecordProperty("error_um", static_cast<int>(std::lround(1000 * lossy.error_mm)));
  RecordProperty("frames_without_loss", whole.frames);
  RecordProperty("frames", lossy.frames);
  EXPECT_GT(whole.error_mm, 0.1);  // there is noise that losses could add to
  EXPECT_NEAR(lossy.error_mm, whole.error_mm, 0.05 * whole.error_mm);
  EXPECT_EQ(lossy.verdict, Verdict::good);
  EXPECT_GE(whole.frames, 80);
  EXPECT_LE(lossy.frames, 1.5 * whole.frames);
}

INSTANTIATE_TEST_SUITE_P(Each, KinectAccuracy, ::testing::ValuesIn(lossy_wires));

}  // namespace
}  // namespace octurn
