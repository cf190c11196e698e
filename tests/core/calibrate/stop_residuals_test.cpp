#include "calibrate/stop_residuals.hpp"

#include <gtest/gtest.h>

#include "core/calibrate/views_of.hpp"

namespace octurn {
namespace {

std::vector<double> distances(const TurnViews& views, const Eigen::Isometry3d& pose) {
  const std::vector<double> as_told(views.angles.size(), 0.0);
  std::vector<double> distances;
  for (std::size_t stop = 0; stop < views.views.size(); ++stop) {
    for_each_residual(views, pose, as_told, stop, {}, [&](const StopResidual& residual) {
      distances.push_back(residual.distance);
    });
  }
  return distances;
}

TEST(StopResiduals, AreTheSameWhereSurfacesAreKeptAsThePoseMoves) {
  const TurnViews views = views_of(rendered_turn(figure(), 8));
  TurnViews keeping = views;
  keeping.looked_up.resize(keeping.pairs.size());
  const Eigen::Isometry3d near = true_platform_from_sensor();
  const Eigen::Isometry3d far = wrong_pose({0.006, -0.004, 0}, {1, 0.3, 0}, 1);
  for (const Eigen::Isometry3d& pose : {near, near, far, near, far}) {
    const std::vector<double> plain = distances(views, pose);
    ASSERT_GT(plain.size(), 500U);
    EXPECT_EQ(distances(keeping, pose), plain);
  }
}

}  // namespace
}  // namespace octurn
