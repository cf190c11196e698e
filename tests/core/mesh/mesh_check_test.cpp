#include "mesh/mesh_check.hpp"

#include <gtest/gtest.h>

#include <array>
#include <utility>
#include <vector>

namespace octurn {
namespace {

using Corner = std::array<float, 3>;

/// A cube of 10 mm with two facets a side, which are counter-clockwise seen from outside.
std::vector<Facet> cube() {
  const auto corner = [](int i) {
    return Corner{i & 1 ? 10.0F : 0.0F, i & 2 ? 10.0F : 0.0F, i & 4 ? 10.0F : 0.0F};
  };
  constexpr std::array<std::array<int, 4>, 6> sides{
      {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}}};
  std::vector<Facet> facets;
  for (const auto& [a, b, c, d] : sides) {
    facets.push_back({.normal = {}, .corners = {corner(a), corner(b), corner(c)}});
    facets.push_back({.normal = {}, .corners = {corner(a), corner(c), corner(d)}});
  }
  return facets;
}

MeshCheck check_of(const std::vector<Facet>& facets) {
  MeshCheck check;
  check.add(facets);
  return check;
}

TEST(MeshCheck, MeasuresACube) {
  const MeshCheck check = check_of(cube());
  EXPECT_TRUE(check.closed());
  EXPECT_EQ(check.facets(), 12U);
  EXPECT_DOUBLE_EQ(check.volume_mm3(), 1000.0);
  EXPECT_EQ(check.bounds_mm().min, Eigen::Vector3d(0, 0, 0));
  EXPECT_EQ(check.bounds_mm().max, Eigen::Vector3d(10, 10, 10));
}

TEST(MeshCheck, DoesNotDependOnHowTheFacetsCome) {
  const std::vector<Facet> facets = cube();
  MeshCheck check;
  for (std::size_t i = facets.size(); i-- > 0;) {
    check.add({&facets[i], 1});
  }
  EXPECT_TRUE(check.closed());
  EXPECT_DOUBLE_EQ(check.volume_mm3(), 1000.0);
}

TEST(MeshCheck, SeesAMissingFacet) {
  for (std::size_t missing = 0; missing < 12; ++missing) {
    std::vector<Facet> facets = cube();
    facets.erase(facets.begin() + static_cast<std::ptrdiff_t>(missing));
    EXPECT_FALSE(check_of(facets).closed());
  }
}

TEST(MeshCheck, SeesAFacetTurnedRound) {
  std::vector<Facet> facets = cube();
  auto corners = facets[5].corners;
  std::swap(corners[0], corners[1]);
  facets[5].corners = corners;
  EXPECT_FALSE(check_of(facets).closed());
}

TEST(MeshCheck, SeesACornerMovedByOneBit) {
  std::vector<Facet> facets = cube();
  auto corners = facets[5].corners;
  corners[0][0] = std::nextafter(corners[0][0], 100.0F);
  facets[5].corners = corners;
  EXPECT_FALSE(check_of(facets).closed());
}

TEST(MeshCheck, TellsWhereTheSurfaceAboveTheBaseIsFilledIn) {
  std::vector<Facet> facets = cube();
  for (const std::size_t base_and_top : {0U, 2U}) {
    facets[base_and_top].attributes = filled_in;
  }
  const MeshCheck check = check_of(facets);
  EXPECT_DOUBLE_EQ(check.unseen_share(), 0.1);
  ASSERT_FALSE(check.unseen_places().empty());
  for (const Eigen::Vector3d& place : check.unseen_places()) {
    EXPECT_NEAR(place.z(), 0.010, 0.0021);  // the top, within half a cell
  }
}

TEST(MeshCheck, CallsNothingNotClosed) { EXPECT_FALSE(MeshCheck{}.closed()); }

}  // namespace
}  // namespace octurn
