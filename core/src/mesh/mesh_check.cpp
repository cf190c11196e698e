#include "mesh/mesh_check.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <memory>

#include "mesh/hash.hpp"
#include "octurn/units.hpp"

namespace octurn {
namespace {

constexpr double base_thickness_mm = 0.1;  // unevenness of a flat base after simplification

std::uint64_t hash_corner(const std::array<float, 3>& corner) {
  const auto bits = [&](std::size_t axis) {
    return std::uint64_t{std::bit_cast<std::uint32_t>(corner[axis] + 0.0F)};  // folds -0 into 0
  };
  return mix_bits((bits(0) << 32 | bits(1)) + mix_bits(bits(2) + 1));
}

std::uint64_t hash_of_edge(std::uint64_t a, std::uint64_t b) {
  return mix_bits(a + std::rotl(b, 32)) - mix_bits(b + std::rotl(a, 32));
}

}  // namespace

void MeshCheck::add(std::span<const Facet> facets) {
  if (facets_ == 0) {
    bounds_mm_ = {.min = Eigen::Vector3d::Constant(std::numeric_limits<double>::infinity()),
                  .max = Eigen::Vector3d::Constant(-std::numeric_limits<double>::infinity())};
  }
  facets_ += facets.size();
  for (const Facet& facet : facets) {
    const auto corners = facet.corners;
    const std::array hashes{hash_corner(corners[0]), hash_corner(corners[1]),
                            hash_corner(corners[2])};
    edges_ += hash_of_edge(hashes[0], hashes[1]) + hash_of_edge(hashes[1], hashes[2]) +
              hash_of_edge(hashes[2], hashes[0]);

    std::array<Eigen::Vector3d, 3> points;
    for (std::size_t i = 0; i < 3; ++i) {
      points[i] = Eigen::Vector3f(corners[i].data()).cast<double>();
      bounds_mm_.min = bounds_mm_.min.cwiseMin(points[i]);
      bounds_mm_.max = bounds_mm_.max.cwiseMax(points[i]);
    }
    const double area = (points[1] - points[0]).cross(points[2] - points[0]).norm();
    area_ += area;
    std::array<Eigen::Vector3d, 3> metres;
    std::ranges::transform(points, metres.begin(), [](const Eigen::Vector3d& point) {
      return Eigen::Vector3d(point.unaryExpr(&metres_from_mm));
    });
    surface_.add(metres);
    const double filled_area = facet.attributes == filled_in ? area : 0;
    filled_area_ += filled_area;
    if (std::ranges::all_of(points, [](const Eigen::Vector3d& point) {
          return std::abs(point.z()) < base_thickness_mm;
        })) {
      base_area_ += area;
      filled_base_area_ += filled_area;
    } else if (filled_area > 0) {
      unseen_places_.add(metres);
    }
    six_volumes_ += points[0].dot(points[1].cross(points[2]));
  }
}

ModelReport make_report(const SurfaceCount& count, const MeshCheck& check) {
  const Eigen::Vector3d size_mm = check.bounds_mm().max - check.bounds_mm().min;
  const double volume = m3_from_mm3(check.volume_mm3());
  return {.leaves = count.leaves,
          .triangles = count.facets,
          .bytes = stl_bytes(count.facets),
          .parts = count.parts,
          .filled_share = check.filled_share(),
          .unseen_share = check.unseen_share(),
          .places = {.unseen = check.unseen_places(),
                     .surface = std::make_shared<SurfaceCells>(check.surface())},
          .watertight = check.closed(),
          .volume = volume,
          .dropped = {.count = count.dropped_parts,
                      .volume = volume * static_cast<double>(count.dropped_leaves) /
                                static_cast<double>(std::max<std::uint64_t>(count.leaves, 1))},
          .size = {metres_from_mm(size_mm.x()), metres_from_mm(size_mm.y()),
                   metres_from_mm(size_mm.z())},
          .bottom = metres_from_mm(check.bounds_mm().min.z())};
}

}  // namespace octurn
