#include "mesh/coarse_mesh.hpp"

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <set>
#include <unordered_map>

namespace octurn {
namespace {

// A surface of area A crosses some 1.5 A / side^2 cells, and a mesh has two facets for each vertex.
constexpr double facets_in_square = 3;
constexpr double coarser = 1.15;  // growth of the side while there are too many facets

using Corners = std::array<Eigen::Vector3d, 3>;

Corners to_corners(const Facet& facet) {
  const auto packed = facet.corners;  // a copy: a facet's members are not aligned
  Corners corners;
  std::ranges::transform(packed, corners.begin(), [](const std::array<float, 3>& corner) {
    return Eigen::Vector3f(corner[0], corner[1], corner[2]).cast<double>().eval();
  });
  return corners;
}

/// Twice the area, as a vector along the outward normal.
Eigen::Vector3d area_vector(const Corners& corners) {
  return (corners[1] - corners[0]).cross(corners[2] - corners[0]);
}

double area(const FacetFile& facets) {
  double doubled = 0;
  facets.read([&](std::span<const Facet> block) {
    for (const Facet& facet : block) {
      doubled += area_vector(to_corners(facet)).norm();
    }
  });
  return doubled / 2;
}

/// The occupied cells of a grid, in order of their first use, and the facets between them.
class Clusters {
 public:
  /// @param side  of a cell, millimetres
  explicit Clusters(double side) : side_(side) {}

  std::size_t facet_count() const { return facets_.size(); }

  void add(const Facet& facet) {
    std::array<std::uint32_t, 3> cells{};
    std::ranges::transform(to_corners(facet), cells.begin(),
                           [this](const Eigen::Vector3d& corner) { return add(corner); });
    if (cells[0] == cells[1] || cells[1] == cells[2] || cells[2] == cells[0]) {
      return;
    }
    // Keeps each facet once: the smallest index first, by a rotation that keeps the orientation.
    std::rotate(cells.begin(), std::ranges::min_element(cells), cells.end());
    if (known_.insert(cells).second) {
      facets_.push_back({.cells = cells, .attributes = facet.attributes});
    }
  }

  std::vector<Facet> mesh() const {
    std::vector<Facet> mesh;
    for (const ClusterFacet& merged : facets_) {
      Corners corners;
      std::ranges::transform(merged.cells, corners.begin(), [this](std::uint32_t cell) {
        return Eigen::Vector3d(cells_[cell].sum / cells_[cell].count);
      });
      const Eigen::Vector3d normal = area_vector(corners).normalized();
      Facet facet{.attributes = merged.attributes};
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const auto at = static_cast<Eigen::Index>(axis);
        facet.normal[axis] = static_cast<float>(normal[at]);
        for (std::size_t corner = 0; corner < 3; ++corner) {
          facet.corners[corner][axis] = static_cast<float>(corners[corner][at]);
        }
      }
      mesh.push_back(facet);
    }
    return mesh;
  }

 private:
  struct Cell {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    double count = 0;
  };
  struct ClusterFacet {
    std::array<std::uint32_t, 3> cells = {};
    std::uint16_t attributes = 0;
  };

  /// Adds a corner to the mean of its cell. @return the cell's index
  std::uint32_t add(const Eigen::Vector3d& corner) {
    std::uint64_t place = 0;
    for (const double coordinate : corner) {  // 21 bits each: a root cube has 2^16 leaves per side
      const auto cell = static_cast<std::int64_t>(std::floor(coordinate / side_));
      place = place << 21U | (static_cast<std::uint64_t>(cell) & 0x1fffffU);
    }
    const auto [found, is_new] = numbers_.emplace(place, static_cast<std::uint32_t>(cells_.size()));
    if (is_new) {
      cells_.emplace_back();
    }
    Cell& cell = cells_[found->second];
    cell.sum += corner;
    ++cell.count;
    return found->second;
  }

  double side_;
  std::unordered_map<std::uint64_t, std::uint32_t> numbers_ =
      {};  // cell indices by packed coordinates
  std::vector<Cell> cells_ = {};
  std::set<std::array<std::uint32_t, 3>> known_ = {};
  std::vector<ClusterFacet> facets_ = {};
};

}  // namespace

std::vector<Facet> coarse_mesh(const FacetFile& facets, std::size_t max_facets) {
  double side = std::sqrt(facets_in_square * area(facets) / static_cast<double>(max_facets));
  for (;;) {
    Clusters clusters(side);
    facets.read([&](std::span<const Facet> block) {
      for (const Facet& facet : block) {
        clusters.add(facet);
      }
    });
    if (clusters.facet_count() <= max_facets) {
      return clusters.mesh();
    }
    side *= coarser;
  }
}

}  // namespace octurn
