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
constexpr double coarser = 1.15;     // growth of the side while there are too many facets
constexpr unsigned index_bits = 21;  // of a cell's index on each axis: three fit into 64 bits

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

struct MeshSize {
  double area = 0;   // square millimetres
  double reach = 0;  // largest absolute coordinate, millimetres
};

MeshSize measure_size(const FacetFile& facets) {
  MeshSize size;
  facets.read([&](std::span<const Facet> block) {
    for (const Facet& facet : block) {
      const Corners corners = to_corners(facet);
      size.area += area_vector(corners).norm() / 2;
      for (const Eigen::Vector3d& corner : corners) {
        size.reach = std::max(size.reach, corner.cwiseAbs().maxCoeff());
      }
    }
  });
  return size;
}

/// The side of the cells to begin with, millimetres: that which leaves about `max_facets`, but no
/// smaller than cell indices of `index_bits` bits allow. Facets without area ask for a side of 0.
double first_side(const MeshSize& size, std::size_t max_facets) {
  constexpr double max_index = (1U << (index_bits - 1)) - 1;
  constexpr double least_reach = 1;  // for a mesh that is a point at the origin
  return std::max(std::sqrt(facets_in_square * size.area / static_cast<double>(max_facets)),
                  std::max(size.reach, least_reach) / max_index);
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
    for (const double coordinate : corner) {
      const auto cell = static_cast<std::int64_t>(std::floor(coordinate / side_));
      constexpr std::uint64_t mask = (1U << index_bits) - 1;
      place = place << index_bits | (static_cast<std::uint64_t>(cell) & mask);
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
  double side = first_side(measure_size(facets), max_facets);
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
