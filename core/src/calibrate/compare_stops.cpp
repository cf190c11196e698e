#include <algorithm>
#include <cmath>
#include <utility>

#include "calibrate/checked_stop.hpp"
#include "calibrate/for_each_stop.hpp"
#include "calibrate/stop_residuals.hpp"
#include "mesh/places.hpp"
#include "octurn/median.hpp"
#include "octurn/units.hpp"

namespace octurn {
namespace {

using Eigen::Vector3d;

// Angles between compared stops. Near stops hardly show a wrong axis, far ones see other surfaces.
constexpr double min_apart_deg = 20;
constexpr double max_apart_deg = 50;

constexpr double max_surface_distance = 0.02;  // metres: beyond it lies another surface
constexpr double confirming_distance = 0.006;  // metres
constexpr double far_disagreements = 2;        // four times the distance between two stops by noise

/// The turn between two stops, radians.
double turn_between(const ScanCheck::Stop& a, const ScanCheck::Stop& b) {
  return Eigen::AngleAxisd(a.object_from_sensor.linear().transpose() *
                           b.object_from_sensor.linear())
      .angle();
}

std::vector<std::size_t> find_partners(const std::vector<const ScanCheck::Stop*>& stops,
                                       std::size_t from, double min_deg, double max_deg) {
  std::vector<std::size_t> partners;
  for (std::size_t to = 0; to < stops.size(); ++to) {
    const double apart = to == from ? 0 : turn_between(*stops[from], *stops[to]);
    if (to != from && apart > radians_from_degrees(min_deg) &&
        apart < radians_from_degrees(max_deg)) {
      partners.push_back(to);
    }
  }
  return partners;
}

/// Comparison of one stop's readings with the others'.
struct Comparison {
  double far_at_1_m = 0;  // metres: larger distances are not noise; they grow with the square
  std::vector<float> distances = {};
  std::vector<Vector3d> disagreeing = {};  // points of the object's frame
  std::vector<Vector3d> contradicted = {};
  std::size_t readings = 0;
};

enum class Agreement { unknown, confirmed, contradicted };

/// @param point  of the object's frame, and its normal
Agreement compare_reading(const ScanCheck::Stop& to, const Vector3d& point, const Vector3d& normal,
                          Comparison& comparison) {
  const Vector3d seen_from = to.object_from_sensor.inverse() * point;
  if (to.empty_depth(seen_from) > seen_from.z() + max_surface_distance) {
    return Agreement::contradicted;
  }
  const auto surface = to.view.look_up(seen_from);
  if (!surface) {
    return Agreement::unknown;
  }
  const Vector3d other = to.object_from_sensor.linear() * surface->normal;
  const double distance = other.dot(point - to.object_from_sensor * surface->point);
  if (std::abs(distance) < max_surface_distance && other.dot(normal) > min_normal_agreement) {
    comparison.distances.push_back(static_cast<float>(std::abs(distance)));
    if (std::abs(distance) > comparison.far_at_1_m * surface->point.z() * surface->point.z()) {
      comparison.disagreeing.push_back(point);
    }
  }
  return std::abs(distance) < confirming_distance ? Agreement::confirmed : Agreement::unknown;
}

Comparison compare_stop(const std::vector<const ScanCheck::Stop*>& stops, std::size_t from,
                        const SensorTraits& sensor) {
  auto partners = find_partners(stops, from, min_apart_deg, max_apart_deg);
  if (partners.empty()) {
    partners = find_partners(stops, from, 0, max_neighbour_deg);
  }
  Comparison comparison{.far_at_1_m = far_disagreements * sensor.disagreement_at_1_m};
  for (const SurfaceReading& reading : stops[from]->readings) {
    const Vector3d point = stops[from]->object_from_sensor * reading.point;
    const Vector3d normal = stops[from]->object_from_sensor.linear() * reading.normal;
    bool is_confirmed = false;
    bool is_contradicted = false;
    for (const std::size_t to : partners) {
      const Agreement agreement = compare_reading(*stops[to], point, normal, comparison);
      is_confirmed |= agreement == Agreement::confirmed;
      is_contradicted |= agreement == Agreement::contradicted;
    }
    ++comparison.readings;
    if (is_contradicted && !is_confirmed) {
      comparison.contradicted.push_back(point);
    }
  }
  return comparison;
}

}  // namespace

StopComparison compare_stops(const std::vector<const ScanCheck::Stop*>& stops,
                             const SensorTraits& sensor, int threads) {
  std::vector<Comparison> of_stops(stops.size());
  for_each_stop(stops.size(), threads,
                [&](std::size_t stop) { of_stops[stop] = compare_stop(stops, stop, sensor); });
  StopComparison all;
  std::vector<float> distances;
  Places disagreeing;
  for (const Comparison& stop : of_stops) {
    distances.insert(distances.end(), stop.distances.begin(), stop.distances.end());
    for (const Vector3d& point : stop.disagreeing) {
      disagreeing.add(point);
    }
    all.contradicted.push_back(static_cast<double>(stop.contradicted.size()) /
                               static_cast<double>(std::max<std::size_t>(stop.readings, 1)));
  }
  all.disagreement = median(std::move(distances));
  all.differing.disagreeing = disagreeing.centres();
  const auto odd = std::ranges::max_element(all.contradicted) - all.contradicted.begin();
  Places contradicted;
  for (const Vector3d& point : of_stops[static_cast<std::size_t>(odd)].contradicted) {
    contradicted.add(point);
  }
  all.differing.contradicted = contradicted.centres();
  return all;
}

namespace {

constexpr std::size_t min_surfaces = 2;  // that stops saw at a leaf
constexpr double swelling_share = 0.95;  // of the leaves are less far outside
constexpr std::size_t min_leaves = 64;

/// What the stops saw at a leaf.
struct SeenLeaf {
  std::vector<double> distances = {};  // metres: of the leaf outside of a stop's surface
  bool is_confirmed = false;
  bool is_contradicted = false;
};

SeenLeaf look_at_leaf(const std::vector<const ScanCheck::Stop*>& stops, const Vector3d& leaf) {
  SeenLeaf seen;
  for (const ScanCheck::Stop* stop : stops) {
    const Vector3d point = stop->object_from_sensor.inverse() * leaf;
    const auto surface = stop->view.look_up(point);
    const double distance = surface ? surface->normal.dot(point - surface->point) : 0;
    if (surface && std::abs(distance) < max_surface_distance) {
      seen.distances.push_back(distance);
      seen.is_confirmed |= std::abs(distance) < confirming_distance;
    }
    seen.is_contradicted |= stop->empty_depth(point) > point.z() + max_surface_distance;
  }
  return seen;
}

}  // namespace

ShellFigures compare_shell(const std::vector<const ScanCheck::Stop*>& stops,
                           std::span<const Vector3d> leaves) {
  std::vector<double> outside;
  std::size_t stray = 0;
  for (const Vector3d& leaf : leaves) {
    SeenLeaf seen = look_at_leaf(stops, leaf);
    if (seen.distances.size() >= min_surfaces) {
      outside.push_back(median(std::move(seen.distances)));
    }
    stray += seen.is_contradicted && !seen.is_confirmed ? 1U : 0U;
  }
  if (outside.size() < min_leaves) {
    return {};
  }
  std::ranges::sort(outside);
  const auto count = static_cast<double>(outside.size());
  return {.swelling = outside[static_cast<std::size_t>(swelling_share * count)],
          .stray_share = static_cast<double>(stray) / static_cast<double>(leaves.size())};
}

}  // namespace octurn
