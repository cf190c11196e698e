#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

#include "core/calibrate/rendered_turn.hpp"
#include "octurn/calibrate.hpp"
#include "octurn/sensor_map.hpp"

namespace octurn {
namespace {

/// An asymmetric figure of 3 cm, different from each side.
Shape small_figure() {
  return joined(block({0.015, 0.01, 0.014}), ball({0.004, 0.002, 0.018}, 0.009));
}

/// A box filter of 2 * reach + 1 samples that lie `stride` apart: 1 filters rows, the width
/// columns.
std::vector<float> box_filtered(const std::vector<float>& image, std::size_t stride, int reach) {
  std::vector<float> filtered(image.size());
  const std::size_t margin = stride * static_cast<std::size_t>(reach);
  for (std::size_t i = margin; i + margin < image.size(); ++i) {
    float sum = 0;
    for (std::size_t k = i - margin; k <= i + margin; k += stride) {
      sum += image[k];
    }
    filtered[i] = sum / static_cast<float>(2 * reach + 1);
  }
  return filtered;
}

/// Adds an error of half a step of a Kinect's disparity that is correlated between neighbours:
/// white noise smoothed by two box filters of 5 x 5 pixels.
void add_common_error(DepthFrame& frame, unsigned seed) {
  std::mt19937 random(seed);
  std::vector<float> error(frame.depth.size());
  for (float& value : error) {
    value = static_cast<float>(random()) / 4294967296.0F - 0.5F;
  }
  const auto width = static_cast<std::size_t>(frame.width);
  for (const std::size_t stride : {width, std::size_t{1}, width, std::size_t{1}}) {
    error = box_filtered(error, stride, 2);
  }
  // Uniform noise of width 1 has an rms of 1 / sqrt(12). Two boxes of 5 leave weights of 1, 2, 3,
  // 4, 5, 4, 3, 2, 1 over 25 in each direction, whose squares sum to 85 / 625.
  constexpr double rms = 0.2887 * 85.0 / 625;
  const Intrinsics lens;
  for (std::size_t i = 0; i < error.size(); ++i) {
    const double z = frame.depth[i] * lens.depth_unit;
    const double off = 0.5 * disparity_unit / rms * static_cast<double>(error[i]);
    const double moved = z > 0 ? 1 / (1 / z + off) : 0;
    frame.depth[i] = static_cast<std::uint16_t>(std::lround(moved / lens.depth_unit));
  }
}

// A small object gives the axis to half a millimetre only. While the solver iterates, many readings
// move by a pixel, so the last step stays larger than for a well-determined axis. By chance the
// stops may agree better in the told pose, although both poses are equally likely.
TEST(CalibrateSmallObject, ConfirmsARigThatIsRight) {
  const CalibrationTurn clean = rendered_turn(small_figure(), 8);
  for (const unsigned seed : {0U, 3U, 9U, 35U, 51U}) {
    CalibrationTurn turn = clean;
    turn.read = [&clean, seed](std::size_t stop) {
      DepthFrame frame = clean.read(stop);
      add_common_error(frame, 100 * seed + static_cast<unsigned>(stop));
      return frame;
    };
    const CalibrationReport report = calibrate(turn);
    EXPECT_TRUE(report.confirms_told()) << "seed " << seed << ": " << report.reason;
  }
}

}  // namespace
}  // namespace octurn
