// A board that is shown to the infrared camera of a simulated Kinect.

#include "capture/board_views.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <stop_token>

#include "calibration/optics_files.hpp"
#include "capture/scan_of_rig.hpp"
#include "octurn/error.hpp"
#include "rig/simulation.hpp"
#include "sensor/wrapped_sensor.hpp"
#include "simulator/infrared_board.hpp"
#include "simulator/printed_board.hpp"
#include "simulator/sensor_unit.hpp"
#include "support/temporary_folder.hpp"

namespace octurn {
namespace {

std::unique_ptr<DepthSensor> open_unit(std::uint32_t unit) {
  return open_sensor(simulation_uri({.unit = unit, .speed = 20}));
}

/// Takes views until there are `count`.
std::vector<DepthBoardView> take_views(DepthSensor& sensor, int count) {
  std::stop_source stop;
  return take_board_views(sensor, stop.get_token(), [&](const Picture&, const BoardLook& look) {
    if (look.taken >= count) {
      stop.request_stop();
    }
  });
}

// The truth is the simulator's: 0.4 pixels of each corner, and a Kinect's noise of depths.
TEST(BoardViews, AreOfABoardInPictureAndDepth) {
  constexpr std::uint32_t unit = 1;
  const SensorOptics truth = optics_of_unit(unit);
  const auto sensor = open_unit(unit);
  const std::vector<DepthBoardView> views = take_views(*sensor, 2);
  ASSERT_EQ(views.size(), 2U);
  for (int hold = 1; hold <= 2; ++hold) {
    const DepthBoardView& view = views[static_cast<std::size_t>(hold - 1)];
    EXPECT_GT(view.corners.size(), 150U);  // of 176
    EXPECT_GT(view.depths.size(), 150U);
    const Eigen::Isometry3d board = infrared_hold(hold, truth);
    const Eigen::Vector3d normal = board.linear().col(2);
    double squares = 0;
    for (const BoardDepth& depth : view.depths) {
      const Eigen::Vector3d ray((depth.pixel.x() - truth.cx) / truth.fx,
                                (depth.pixel.y() - truth.cy) / truth.fy, 1);
      const double inverse = normal.dot(ray) / (normal.dot(board.translation()) * board_square);
      const double reported = truth.depth_scale * inverse - truth.depth_offset_per_m;
      squares += std::pow(depth.inverse_depth / reported - 1, 2);
    }
    // The fixed pattern's 0.8 steps are 0.15 % at half a metre, and k1 bends a tilted plane.
    EXPECT_LT(std::sqrt(squares / static_cast<double>(view.depths.size())), 0.005);
  }
}

TEST(BoardViews, AreDroppedWhenTheBoardMovesMeanwhile) {
  /// Somebody moves the board as soon as depths are taken.
  class Restless final : public WrappedSensor {
   public:
    using WrappedSensor::WrappedSensor;
    std::optional<TimedFrame> read(const std::stop_token& stop) override {
      WrappedSensor::show_board(20);
      ++reads;
      return WrappedSensor::read(stop);
    }
    int reads = 0;
  };
  Restless sensor(open_unit(1));
  std::stop_source stop;
  int pictures = 0;
  int most = 0;
  const auto views =
      take_board_views(sensor, stop.get_token(), [&](const Picture&, const BoardLook& look) {
        most = std::max(most, look.taken);
        if (++pictures == 8) {
          stop.request_stop();
        }
      });
  EXPECT_TRUE(views.empty());
  EXPECT_EQ(most, 0);
  EXPECT_GT(sensor.reads, 0) << "no view was begun";
}

TEST(BoardViews, NeedAnInfraredCamera) {
  class Blind final : public WrappedSensor {
   public:
    using WrappedSensor::WrappedSensor;
    std::optional<Picture> read_infrared(const std::stop_token& stop) override {
      return DepthSensor::read_infrared(stop);
    }
  };
  Blind sensor(open_unit(0));
  try {
    take_views(sensor, 1);
    FAIL() << "a sensor without infrared pictures gave some";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::sensor_other);
  }
}

TEST(DepthSensorStreams, GiveDepthAgainAfterInfraredPictures) {
  const auto sensor = open_unit(0);
  const std::optional<TimedFrame> before = sensor->read({});
  const std::optional<Picture> picture = sensor->read_infrared({});
  const std::optional<TimedFrame> after = sensor->read({});
  ASSERT_TRUE(before && picture && after);
  EXPECT_EQ(picture->width, 640);
  EXPECT_EQ(picture->samples.size(), std::size_t{640} * 480);
  EXPECT_EQ(after->frame.depth.size(), before->frame.depth.size());
  EXPECT_GT(after->time, before->time);
}

TEST(OpticsOfABoard, AreKeptWithTheirSource) {
  const TemporaryFolder data;
  keep_optics(data.path(), "A1",
              {.optics = {.value = {.depth_scale = 1.012}, .sigma = {.depth_scale = 0.002}},
               .origin = OpticsOrigin::board,
               .at = "2026-11-28T10:00:00Z"});
  const auto kept = optics_record(data.path(), "A1");
  ASSERT_TRUE(kept);
  EXPECT_EQ(kept->origin, OpticsOrigin::board);
  EXPECT_EQ(kept->optics.value.depth_scale, 1.012);
  EXPECT_EQ(scale_sigma(1, kept->optics), 0.002);  // a board makes sizes more certain
  EXPECT_EQ(scale_sigma(1, {}), unknown_scale_sigma);
}

}  // namespace
}  // namespace octurn
