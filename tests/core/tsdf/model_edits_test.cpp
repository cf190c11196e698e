// Cuts, erased balls, and models that are laid and scaled.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <set>
#include <string>
#include <vector>

#include "core/mesh/surface.hpp"
#include "core/tsdf/rendered.hpp"
#include "mesh/mesh_check.hpp"
#include "octurn/model.hpp"
#include "octurn/scan_folder.hpp"
#include "support/ball_scan.hpp"
#include "support/temporary_folder.hpp"
#include "support/thrown_error.hpp"

namespace octurn {
namespace {

using Eigen::Vector3d;

const Vector3d block_size(0.06, 0.04, 0.07);

ReconstructOptions edit_options(const ModelEdits& edits = {}) {
  return {.method = Method::solid,
          .leaf_size = 0.002,
          .clip = {.min = {-0.14, -0.14, 0.002}, .max = {0.14, 0.14, 0.4}},
          .edits = edits};
}

SnapshotSource block_scan() { return rendered(block(block_size), 8); }

struct EditedModel {
  std::vector<Facet> facets = {};
  ModelReport report = {};
};

EditedModel build(const ReconstructOptions& options, const SnapshotSource& snapshots) {
  const TemporaryFolder folder;
  write_ball_scan(folder.path() / "scan", 1);  // whose snapshots are not read
  EditedModel model;
  model.report =
      *build_model({.folder = folder.path() / "scan",
                    .scan = read_scan(folder.path() / "scan"),
                    .options = options,
                    .solves_pose = false,
                    .is_judged = false,
                    .snapshots = [&](const Scan&) { return snapshots; },
                    .write =
                        [&](Reconstructor& reconstructor, const SnapshotSource& stored) {
                          return write_model(reconstructor, stored,
                                             [&](std::span<const Facet> some) {
                                               model.facets.insert(model.facets.end(), some.begin(),
                                                                   some.end());
                                             },
                                             {});
                        }},
                   {})
           .report;
  return model;
}

std::vector<Vector3d> corner_points(const Facet& facet) {
  std::vector<Vector3d> points;
  const auto corners = facet.corners;
  for (const auto& corner : corners) {
    points.emplace_back(Eigen::Vector3f(corner.data()).cast<double>() / 1000);
  }
  return points;
}

/// Square metres of the facets whose corners all satisfy a condition.
double area_where(const std::vector<Facet>& facets,
                  const std::function<bool(const Vector3d&)>& holds) {
  double area = 0;
  for (const Facet& facet : facets) {
    if (const auto p = corner_points(facet); std::ranges::all_of(p, holds)) {
      area += (p[1] - p[0]).cross(p[2] - p[0]).norm() / 2;
    }
  }
  return area;
}

CutPlane oblique_cut() {
  const Vector3d normal = Vector3d(0.3, -0.2, 1).normalized();
  return {.normal = normal, .distance = normal.dot(Vector3d(0, 0, 0.04))};
}

// Vertices keep 0.036 mm / sqrt 2 from the ends of their edges, for slicers, and an edge collapse
// of a plane leaves them there.
constexpr double flatness = 0.00003;

TEST(Edits, CutABlockWithAFlatClosedSection) {
  const CutPlane cut = oblique_cut();
  const EditedModel model = build(edit_options({.cuts = {cut}}), block_scan());
  EXPECT_TRUE(model.report.watertight);
  const Topology topology = topology_of(model.facets);
  EXPECT_TRUE(topology.manifold);
  EXPECT_EQ(topology.euler, 2);
  for (const Facet& facet : model.facets) {
    for (const Vector3d& corner : corner_points(facet)) {
      EXPECT_LT(cut.normal.dot(corner) - cut.distance, flatness);
    }
  }
  // The plane meets the block's axis at 40 mm. 2 % is a tenth of a voxel over the whole surface.
  const double volume = 0.06 * 0.04 * 0.04;
  EXPECT_NEAR(model.report.volume, volume, volume * 0.02);
  const double section = area_where(model.facets, [&](const Vector3d& p) {
    return std::abs(cut.normal.dot(p) - cut.distance) < flatness;
  });
  const double expected = 0.06 * 0.04 / cut.normal.z();
  EXPECT_LT(section, expected * 1.02);
  // Marching cubes bevel the rim by up to a voxel of 1.95 mm.
  EXPECT_GT(section, expected - 0.00195 * 2 * (0.06 + 0.04) / cut.normal.z());
}

TEST(Edits, ChangeNothingBeyondAVoxelOfTheCut) {
  ReconstructOptions whole = edit_options();
  whole.target_error = 0;  // edge collapse could choose other edges
  ReconstructOptions part = whole;
  const CutPlane cut = oblique_cut();
  part.edits.cuts = {cut};
  const auto kept_facets = [&](const ReconstructOptions& options) {
    std::set<std::string> kept;
    for (const Facet& facet : build(options, block_scan()).facets) {
      if (std::ranges::all_of(corner_points(facet), [&](const Vector3d& p) {
            return cut.normal.dot(p) - cut.distance < -0.004;
          })) {
        kept.emplace(reinterpret_cast<const char*>(&facet), sizeof facet);
      }
    }
    return kept;
  };
  const auto kept = kept_facets(part);
  EXPECT_GT(kept.size(), 1000U);
  EXPECT_EQ(kept, kept_facets(whole));
}

TEST(Edits, CropToABoxByItsSixPlanes) {
  std::vector<CutPlane> sides;
  const Vector3d low(-0.021, -0.03, 0.0153);
  const Vector3d high(0.0207, 0.03, 0.0507);
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    sides.push_back({.normal = -Vector3d::Unit(axis), .distance = -low[axis]});
    sides.push_back({.normal = Vector3d::Unit(axis), .distance = high[axis]});
  }
  const EditedModel model = build(edit_options({.cuts = sides}), block_scan());
  EXPECT_TRUE(topology_of(model.facets).manifold);
  EXPECT_NEAR(model.report.bottom, low.z(), flatness);
  EXPECT_NEAR(model.report.size.x(), high.x() - low.x(), 2 * flatness);
  EXPECT_NEAR(model.report.size.y(), 0.04, 0.0006);  // the block's own sides, as scanned
  EXPECT_NEAR(model.report.size.z(), high.z() - low.z(), 2 * flatness);
}

TEST(Edits, EraseABall) {
  const ErasedBall ball{.centre = {0, 0, 0.07}, .radius = 0.015};
  const EditedModel whole = build(edit_options(), block_scan());
  const EditedModel model = build(edit_options({.erased = {ball}}), block_scan());
  EXPECT_TRUE(topology_of(model.facets).manifold);
  const double half_ball = 2.0 / 3 * std::numbers::pi * std::pow(ball.radius, 3);
  EXPECT_NEAR(whole.report.volume - model.report.volume, half_ball, half_ball * 0.05);
  for (const Facet& facet : model.facets) {
    for (const Vector3d& corner : corner_points(facet)) {
      // A chord of a voxel lies 2^2 / (8 * 15) = 0.03 mm inside the ball.
      EXPECT_GT((corner - ball.centre).norm(), ball.radius - 0.00004 - flatness);
    }
  }
}

TEST(Edits, KeepAllPartsOfWhatWasCutThrough) {
  // A slot of 10 mm across the block: planes alone remove half-spaces, so it is a row of balls.
  std::vector<ErasedBall> slot;
  for (int y = -24; y <= 24; y += 2) {
    for (int z = 0; z <= 72; z += 2) {
      slot.push_back({.centre = {0.0, y / 1000.0, z / 1000.0}, .radius = 0.005});
    }
  }
  ReconstructOptions options = edit_options({.erased = slot});
  options.target_error = 0;
  const EditedModel model = build(options, block_scan());
  EXPECT_EQ(model.report.parts, 2U);
  EXPECT_EQ(topology_of(model.facets).euler, 4);
}

TEST(Edits, CutTheFootOffWithoutANewOne) {
  const CutPlane cut{.normal = -Vector3d::UnitZ(), .distance = -0.0201};
  const EditedModel model = build(edit_options({.cuts = {cut}}), block_scan());
  EXPECT_TRUE(model.report.watertight);
  EXPECT_NEAR(model.report.bottom, 0.0201, flatness);
}

TEST(Edits, LayAModelOnItsSectionAndScaleIt) {
  const CutPlane cut = oblique_cut();
  const EditedModel standing = build(edit_options({.cuts = {cut}}), block_scan());
  const LaidSide lay{.down = cut.normal, .point = Vector3d(0, 0, 0.04)};
  const EditedModel laid =
      build(edit_options({.cuts = {cut}, .lay = lay, .scale = 0.5}), block_scan());
  EXPECT_TRUE(laid.report.watertight);
  EXPECT_TRUE(topology_of(laid.facets).manifold);
  EXPECT_NEAR(laid.report.bottom, 0, flatness);
  EXPECT_NEAR(laid.report.volume, standing.report.volume / 8, standing.report.volume * 1e-5);
  const double base = area_where(laid.facets, [](const Vector3d& p) { return p.z() < flatness; });
  EXPECT_GT(base, 0.06 * 0.04 / cut.normal.z() / 4 * 0.85);  // without the rim, as above
  const Eigen::Affine3d back = model_from_object({.lay = lay, .scale = 0.5}).inverse();
  const Shape shape = block(block_size);
  for (const Facet& facet : laid.facets) {
    for (const Vector3d& corner : corner_points(facet)) {
      EXPECT_LT(shape(back * corner), 0.001);
    }
  }
}

TEST(Edits, TurnAModelOver) {
  const LaidSide lay{.down = Vector3d::UnitZ(), .point = {0, 0, 0.07}};
  const Eigen::Affine3d turned = model_from_object({.lay = lay});
  EXPECT_TRUE((turned * Vector3d(0.01, 0.02, 0.07)).isApprox(Vector3d(0.01, -0.02, 0)));
  EXPECT_NEAR(turned.linear().determinant(), 1, 1e-12);
  const LaidSide as_it_is{.down = -Vector3d::UnitZ(), .point = {0, 0, 0.07}};
  EXPECT_TRUE(model_from_object({.lay = as_it_is}).linear().isIdentity());
  const Vector3d down = Vector3d(1, 2, 0.5).normalized();
  const Eigen::Affine3d laid = model_from_object({.lay = LaidSide{.down = down}, .scale = 3});
  EXPECT_TRUE((laid.linear() * down).isApprox(Vector3d(0, 0, -3)));
}

TEST(Edits, LimitTheNumberOfTriangles) {
  const SnapshotSource snapshots = rendered(ball({0, 0, 0.05}, 0.045), 8);
  const std::size_t usual = build(edit_options(), snapshots).facets.size();
  for (const std::uint64_t max : {usual / 2, usual / 4}) {
    ReconstructOptions options = edit_options();
    options.solid.max_triangles = max;
    const EditedModel model = build(options, snapshots);
    EXPECT_LE(model.facets.size(), max);
    EXPECT_GT(model.facets.size(), max / 2);  // and not far fewer
    EXPECT_TRUE(topology_of(model.facets).manifold);
  }
  ReconstructOptions few = edit_options();
  few.solid.max_triangles = 4;
  EXPECT_EQ(code_thrown_by([&] { build(few, snapshots); }), "model-too-large");
  ReconstructOptions ample = edit_options();
  ample.solid.max_triangles = usual;
  EXPECT_EQ(build(ample, snapshots).facets.size(), usual);
}

TEST(Edits, GiveTheSameBytesForAnyThreadsAndMemory) {
  const ModelEdits edits{.cuts = {oblique_cut()},
                         .erased = {{.centre = {0.03, 0, 0.02}, .radius = 0.01}},
                         .lay = LaidSide{.down = oblique_cut().normal, .point = {0, 0, 0.04}},
                         .scale = 1.7};
  ReconstructOptions options = edit_options(edits);
  const EditedModel alone = build(options, block_scan());
  options.threads = 3;
  EXPECT_TRUE(same_bytes(build(options, block_scan()).facets, alone.facets));
  options.memory_limit = std::size_t{52} << 20U;
  EXPECT_TRUE(same_bytes(build(options, block_scan()).facets, alone.facets));
}

TEST(Edits, AreRefusedWhereTheyAreImpossible) {
  const auto thrown_by = [](const ModelEdits& edits, Method method = Method::solid) {
    ReconstructOptions options = edit_options(edits);
    options.method = method;
    return code_thrown_by([&] { make_reconstructor(options); });
  };
  EXPECT_EQ(thrown_by({.cuts = {oblique_cut()}}, Method::intersection), "bad-settings");
  EXPECT_EQ(thrown_by({.erased = {{.radius = 1}}}, Method::intersection), "bad-settings");
  EXPECT_EQ(thrown_by({.cuts = {{.normal = {0, 0, 2}}}}), "bad-settings");
  EXPECT_EQ(thrown_by({.cuts = {{.distance = std::nan("")}}}), "bad-settings");
  EXPECT_EQ(thrown_by({.erased = {{.radius = 0}}}), "bad-settings");
  EXPECT_EQ(thrown_by({.lay = LaidSide{.down = Vector3d::Zero()}}), "bad-settings");
  EXPECT_EQ(thrown_by({.scale = 0}), "bad-settings");
}

TEST(Edits, RemovingEverythingLeavesNoModel) {
  const CutPlane cut{.normal = Vector3d::UnitZ(), .distance = -0.001};
  EXPECT_EQ(code_thrown_by([&] { build(edit_options({.cuts = {cut}}), block_scan()); }), "empty");
}

}  // namespace
}  // namespace octurn
