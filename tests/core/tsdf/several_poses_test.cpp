#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <numbers>
#include <vector>

#include "core/mesh/surface.hpp"
#include "core/tsdf/rendered.hpp"
#include "mesh/mesh_check.hpp"
#include "octurn/reconstruct.hpp"

namespace octurn {
namespace {

constexpr double height = 0.05;  // metres, of the block
constexpr double dent = 0.02;    // radius
constexpr std::size_t stops = 16;

const Box clip_box{.min = {-0.14, -0.14, 0.002}, .max = {0.14, 0.14, 0.4}};

/// A block with half a ball hollowed out of its underside.
Shape dented() {
  return [whole = block({0.09, 0.07, height}), gap = ball({0, 0, 0}, dent)](
             const Eigen::Vector3d& p) { return std::max(whole(p), -gap(p)); };
}

double dented_cm3() {
  return cm3_from_m3(0.09 * 0.07 * height - 2 * std::numbers::pi / 3 * dent * dent * dent);
}

Eigen::Isometry3d turned_over() {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() = Eigen::AngleAxisd(std::numbers::pi, Eigen::Vector3d(1, 0.5, 0).normalized())
                      .toRotationMatrix();
  pose.translation().z() = height;
  return pose;
}

/// The turns of an object in these poses, one after the other.
SnapshotSource turns_of(const Shape& object, const std::vector<Placement>& placements) {
  std::vector<SnapshotSource> turns;
  for (const Placement& placement : placements) {
    const Eigen::Isometry3d& pose = placement.object_from_platform;
    turns.push_back(rendered([=](const Eigen::Vector3d& p) { return object(pose * p); }, stops));
  }
  return {.count = stops * placements.size(), .read = [=](std::size_t i) {
            Snapshot snapshot = turns[i / stops].read(i % stops);
            snapshot.pose = static_cast<int>(i / stops);
            snapshot.object_from_sensor =
                placements[i / stops].object_from_platform * snapshot.object_from_sensor;
            return snapshot;
          }};
}

struct Model {
  std::vector<Facet> facets = {};
  SurfaceCount count = {};
  MeshCheck check = {};
};

Model model_of(const SnapshotSource& snapshots, const ReconstructOptions& options) {
  const auto reconstruction = make_reconstructor(options);
  reconstruction->add(snapshots);
  Model model;
  model.count = reconstruction->surface(snapshots, [&](std::span<const Facet> some) {
    model.facets.insert(model.facets.end(), some.begin(), some.end());
    model.check.add(some);
  });
  return model;
}

ReconstructOptions solid(const std::vector<Placement>& placements) {
  return {.method = Method::solid,
          .leaf_size = 0.002,
          .clip = {.min = {-0.2, -0.2, -0.1}, .max = {0.2, 0.2, 0.4}},
          .placements = placements};
}

TEST(SolidOfSeveralPoses, HasTheUndersideThatTheSecondPoseSaw) {
  const std::vector<Placement> placements{
      {.clip = clip_box}, {.object_from_platform = turned_over(), .clip = clip_box}};

  const Model model = model_of(turns_of(dented(), placements), solid(placements));

  EXPECT_TRUE(topology_of(model.facets).manifold);
  EXPECT_EQ(model.count.parts, 1U);
  // Edges are rounded by a voxel. A single pose would fill in the dent, 16.8 of 298 cm3.
  EXPECT_NEAR(cm3_from_m3(m3_from_mm3(model.check.volume_mm3())), dented_cm3(),
              0.02 * dented_cm3());
  EXPECT_NEAR(model.check.bounds_mm().min.z(), 0, 0.5);
}

TEST(SolidOfSeveralPoses, HasAFlatFootWhereNothingSawIt) {
  Eigen::Isometry3d quarter_turn = Eigen::Isometry3d::Identity();
  quarter_turn.linear() =
      Eigen::AngleAxisd(std::numbers::pi / 2, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  const std::vector<Placement> placements{{.clip = clip_box},
                                          {.object_from_platform = quarter_turn, .clip = clip_box}};

  const Model model = model_of(turns_of(dented(), placements), solid(placements));

  EXPECT_TRUE(topology_of(model.facets).manifold);
  EXPECT_NEAR(model.check.bounds_mm().min.z(), 0, 1e-3);
  EXPECT_NEAR(cm3_from_m3(m3_from_mm3(model.check.volume_mm3())), 90 * 70 * height, 0.03 * 315);
  // Unobserved space right above the platform widens the block by the truncation at most.
  const Eigen::Vector3d size = model.check.bounds_mm().max - model.check.bounds_mm().min;
  EXPECT_NEAR(size.x(), 90, 6);
  EXPECT_NEAR(size.y(), 70, 6);
}

/// A block of 90 x 70 mm that stands on one of its long edges.
Eigen::Isometry3d tilted(double angle) {
  Eigen::Isometry3d platform_from_object(Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitX()));
  platform_from_object.pretranslate(Eigen::Vector3d(0, 0, 0.035 * std::sin(angle)));
  return platform_from_object.inverse();
}

TEST(SolidOfSeveralPoses, HasAFlatFootAboveFreeSpaceThatTheOtherPoseSaw) {
  const std::vector<Placement> placements{{.clip = clip_box},
                                          {.object_from_platform = tilted(0.6), .clip = clip_box}};
  const SnapshotSource turns = turns_of(block({0.09, 0.07, 0.09}), placements);

  const Model model = model_of(turns, solid(placements));

  EXPECT_TRUE(topology_of(model.facets).manifold);
  for (const Facet& facet : model.facets) {
    const auto packed = facet.corners;
    for (const auto& [x, y, z] : packed) {
      if (std::abs(x) < 35 && std::abs(y) < 25 && z < 45) {
        ASSERT_NEAR(z, 0, 1.5) << x << ' ' << y;
      }
    }
  }
}

TEST(SolidOfSeveralPoses, IsTheSameInSlabs) {
  const std::vector<Placement> placements{
      {.clip = clip_box}, {.object_from_platform = turned_over(), .clip = clip_box}};
  const SnapshotSource turns = turns_of(dented(), placements);
  ReconstructOptions options = solid(placements);
  const Model whole = model_of(turns, options);
  options.threads = 2;
  options.memory_limit = std::size_t{36} << 20U;

  const Model slabs = model_of(turns, options);

  ASSERT_EQ(slabs.facets.size(), whole.facets.size());
  EXPECT_EQ(
      std::memcmp(slabs.facets.data(), whole.facets.data(), whole.facets.size() * sizeof(Facet)),
      0);
}

TEST(SolidOfSeveralPoses, RefusesASnapshotOfAPoseThatIsNotListed) {
  const auto reconstruction = make_reconstructor(solid({{.clip = clip_box}, {.clip = clip_box}}));
  Snapshot snapshot = rendered(dented(), 1).read(0);
  snapshot.pose = 2;

  EXPECT_THROW(reconstruction->add(snapshot), std::invalid_argument);
}

TEST(IntersectionOfSeveralPoses, CoversTheUndersideThatTheSecondPoseSaw) {
  const std::vector<Placement> placements{
      {.clip = clip_box}, {.object_from_platform = turned_over(), .clip = clip_box}};
  ReconstructOptions options = solid(placements);
  options.method = Method::intersection;

  const Model model = model_of(turns_of(dented(), placements), options);

  // The dent has surface as deep as the sensor sees into it; a single pose leaves none there.
  bool in_dent = false;
  for (const Facet& facet : model.facets) {
    const auto corners = facet.corners;  // a copy: a facet is packed, so its corners are unaligned
    for (const auto& corner : corners) {
      const Eigen::Vector3d at(static_cast<double>(corner[0]), static_cast<double>(corner[1]),
                               static_cast<double>(corner[2]));
      in_dent = in_dent || (at.z() > 5 && std::abs(at.norm() - mm_from_metres(dent)) < 4);
    }
  }
  EXPECT_TRUE(in_dent);
  EXPECT_TRUE(model.check.closed());
}

}  // namespace
}  // namespace octurn
