#include <Eigen/Geometry>
#include <array>
#include <bit>
#include <cmath>
#include <limits>

#include "octurn/mesh_report.hpp"

namespace octurn {
namespace {

constexpr float base_thickness_mm = 0.1F;  // what the simplifier may leave of a flat base

/// The finalizer of SplitMix64 (Steele, Lea and Flood 2014).
std::uint64_t mixed(std::uint64_t bits) {
  bits = (bits ^ bits >> 30) * 0xbf58476d1ce4e5b9U;
  bits = (bits ^ bits >> 27) * 0x94d049bb133111ebU;
  return bits ^ bits >> 31;
}

/// Linear in the coordinates' bits: the edges' hash mixes it.
std::uint64_t hash_of(const std::array<float, 3>& corner) {
  const auto bits = [&](std::size_t axis) {
    return std::uint64_t{std::bit_cast<std::uint32_t>(corner[axis] + 0.0F)};  // folds -0 into 0
  };
  return bits(0) * 0x9e3779b97f4a7c15U + bits(1) * 0xd1342543de82ef95U +
         bits(2) * 0xda942042e4dd58b5U;
}

/// Changes its sign when the edge is turned round.
std::uint64_t hash_of_edge(std::uint64_t a, std::uint64_t b) { return (a - b) * mixed(a + b); }

}  // namespace

void MeshCheck::add(std::span<const Facet> facets) {
  if (facets_ == 0) {
    bounds_mm_ = {.min = Eigen::Vector3d::Constant(std::numeric_limits<double>::infinity()),
                  .max = Eigen::Vector3d::Constant(-std::numeric_limits<double>::infinity())};
  }
  facets_ += facets.size();
  Eigen::Array3f min = bounds_mm_.min.cast<float>();  // exact: they are coordinates of corners
  Eigen::Array3f max = bounds_mm_.max.cast<float>();
  for (const Facet& facet : facets) {
    const auto corners = facet.corners;
    const std::array hashes{hash_of(corners[0]), hash_of(corners[1]), hash_of(corners[2])};
    edges_ += hash_of_edge(hashes[0], hashes[1]) + hash_of_edge(hashes[1], hashes[2]) +
              hash_of_edge(hashes[2], hashes[0]);

    std::array<Eigen::Vector3d, 3> points;
    bool in_base = true;
    for (std::size_t i = 0; i < 3; ++i) {
      const Eigen::Array3f corner(corners[i].data());
      min = min.min(corner);
      max = max.max(corner);
      in_base = in_base && std::abs(corners[i][2]) < base_thickness_mm;
      points[i] = corner.cast<double>();
    }
    const Eigen::Vector3d normal = (points[1] - points[0]).cross(points[2] - points[0]);
    six_volumes_ += points[0].dot(normal);
    const double area = normal.norm();
    const double filled_area = facet.attributes == filled_in ? area : 0;
    area_ += area;
    filled_area_ += filled_area;
    if (in_base) {
      base_area_ += area;
      filled_base_area_ += filled_area;
    }
  }
  bounds_mm_ = {.min = min.matrix().cast<double>(), .max = max.matrix().cast<double>()};
}

}  // namespace octurn
