#include "calibrate/missing_part.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "calibrate/checked_stop.hpp"
#include "mesh/places.hpp"
#include "mesh/surface_cells.hpp"

namespace octurn {
namespace {

using Eigen::Vector3d;

constexpr double max_gap = 0.006;     // metres, at the sensor's `noise_distance`
constexpr double voxels_of_gap = 2;   // lost by carving and simplification
constexpr std::size_t min_cells = 6;  // 1.5 cm2: fewer are readings between two surfaces
constexpr double min_length = 0.012;  // metres

/// Cells without any surface near.
std::set<ObjectCell> find_bare_cells(const ScanFigures& scan, const ModelReport& model) {
  const double gap = max_gap * scan.noise_growth() + voxels_of_gap * voxel_side(model);
  std::set<ObjectCell> bare;
  for (const Vector3d& point : scan.seen) {
    const bool is_noise = point.z() - object_cell_side / 2 < scan.below.noise_end;
    if (!is_noise && (!model.places.surface || !model.places.surface->has_near(point, gap))) {
      bare.insert(to_object_cell(point));
    }
  }
  return bare;
}

/// Takes a cell, and all that are joined to it by a face, an edge or a corner, out of a set.
std::vector<ObjectCell> take_cluster(std::set<ObjectCell>& cells) {
  std::vector<ObjectCell> cluster = {*cells.begin()};
  cells.erase(cells.begin());
  for (std::size_t next = 0; next < cluster.size(); ++next) {
    for (int i = 0; i < 27; ++i) {
      ObjectCell beside = cluster[next];
      beside[0] = static_cast<std::int16_t>(beside[0] + i % 3 - 1);
      beside[1] = static_cast<std::int16_t>(beside[1] + i / 3 % 3 - 1);
      beside[2] = static_cast<std::int16_t>(beside[2] + i / 9 - 1);
      if (cells.erase(beside) > 0) {
        cluster.push_back(beside);
      }
    }
  }
  return cluster;
}

MissingPart measure(const std::vector<ObjectCell>& cluster) {
  Vector3d low = find_middle(cluster.front());
  Vector3d high = low;
  Places places;
  for (const ObjectCell& cell : cluster) {
    const Vector3d middle = find_middle(cell);
    low = low.cwiseMin(middle);
    high = high.cwiseMax(middle);
    places.add(middle);
  }
  return {.length = (high - low).maxCoeff() + object_cell_side, .places = places.centres()};
}

}  // namespace

double voxel_side(const ModelReport& model) {
  return model.leaves == 0 ? 0
                           : std::cbrt(std::abs(model.volume) / static_cast<double>(model.leaves));
}

std::optional<MissingPart> find_missing_part(const ScanFigures& scan, const ModelReport& model) {
  std::set<ObjectCell> bare = find_bare_cells(scan, model);
  std::vector<ObjectCell> largest;
  while (!bare.empty()) {
    std::vector<ObjectCell> cluster = take_cluster(bare);
    if (cluster.size() > largest.size()) {
      largest = std::move(cluster);
    }
  }
  if (largest.size() < min_cells) {
    return std::nullopt;
  }
  MissingPart part = measure(largest);
  return part.length < min_length ? std::nullopt : std::optional(std::move(part));
}

}  // namespace octurn
