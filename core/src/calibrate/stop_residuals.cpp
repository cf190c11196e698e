#include "calibrate/stop_residuals.hpp"

#include <algorithm>
#include <array>
#include <numbers>
#include <optional>
#include <span>
#include <utility>

#include "calibrate/for_each_stop.hpp"
#include "octurn/median.hpp"
#include "octurn/units.hpp"

namespace octurn {
namespace {

// Stops at small angles share more surface; those at large ones determine the axis better.
constexpr std::array apart_deg = {15.0, 30.0, 45.0, 75.0, 90.0};
constexpr double tolerance_deg = 7.6;  // stops of a turn are rarely just so far apart
constexpr std::size_t few_stops = 12;  // up to here the largest angle is compared, too

/// The angle from `a` to `b`, from -pi to pi.
double angle_between(double a, double b) { return std::remainder(b - a, 2 * std::numbers::pi); }

/// The stop whose angle from another is nearest to `wanted`, within the tolerance.
std::optional<std::size_t> find_stop(const std::vector<double>& angles, std::size_t from,
                                     double wanted, double tolerance) {
  std::optional<std::size_t> nearest;
  double error = tolerance;
  for (std::size_t to = 0; to < angles.size(); ++to) {
    const double off = std::abs(angle_between(wanted, angle_between(angles[from], angles[to])));
    if (to != from && off < error) {
      error = off;
      nearest = to;
    }
  }
  return nearest;
}

std::vector<StopPair> pairs_at(const std::vector<double>& angles, std::span<const double> turns,
                               double tolerance) {
  std::vector<StopPair> pairs;
  for (std::size_t from = 0; from < angles.size(); ++from) {
    std::vector<std::size_t> partners;
    for (const double turn : turns) {
      for (const double wanted : {turn, -turn}) {
        if (const auto to = find_stop(angles, from, wanted, tolerance)) {
          partners.push_back(*to);
        }
      }
    }
    std::ranges::sort(partners);
    partners.erase(std::unique(partners.begin(), partners.end()), partners.end());
    for (const std::size_t to : partners) {
      pairs.push_back({.from = from, .to = to});
    }
  }
  return pairs;
}

}  // namespace

std::vector<StopPair> make_stop_pairs(const std::vector<double>& angles) {
  std::array<double, apart_deg.size()> turns{};
  std::ranges::transform(apart_deg, turns.begin(), radians_from_degrees);
  const std::size_t used = angles.size() <= few_stops ? turns.size() : turns.size() - 1;
  auto pairs = pairs_at(angles, std::span(turns).first(used), radians_from_degrees(tolerance_deg));
  if (pairs.empty()) {
    const std::array half = {radians_from_degrees(max_neighbour_deg / 2)};
    pairs = pairs_at(angles, half, half.front());
  }
  return pairs;
}

double median_residual(const TurnViews& turn, const Eigen::Isometry3d& platform_from_sensor,
                       const std::vector<double>& stop_offsets, int threads) {
  std::vector<std::vector<float>> of_stops(turn.views.size());
  for_each_stop(of_stops.size(), threads, [&](std::size_t stop) {
    for_each_residual(turn, platform_from_sensor, stop_offsets, stop, {},
                      [&](const StopResidual& residual) {
                        of_stops[stop].push_back(static_cast<float>(std::abs(residual.distance)));
                      });
  });
  std::vector<float> all;
  for (const std::vector<float>& some : of_stops) {
    all.insert(all.end(), some.begin(), some.end());
  }
  return median(std::move(all));
}

}  // namespace octurn
