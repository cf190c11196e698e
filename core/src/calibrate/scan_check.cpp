#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <numbers>
#include <numeric>

#include "calibrate/checked_stop.hpp"
#include "mesh/places.hpp"
#include "octurn/quality.hpp"

namespace octurn {
namespace {

using Stops = std::vector<const ScanCheck::Stop*>;

constexpr std::size_t height_window = 5;  // steps of height that a platform's readings spread over
constexpr std::size_t min_platform_readings = 500;  // at a stop
constexpr double noise_share = 0.01;                // of the readings at the platform's height
constexpr double bottom_step = 0.0001;              // metres
constexpr double share_without_hole = 0.2;          // of the stops

/// The largest angle between neighbouring stops, radians, from the sensor's headings in the
/// object's frame.
double find_widest_gap(const Stops& stops) {
  std::vector<double> headings;
  for (const ScanCheck::Stop* stop : stops) {
    const Eigen::Vector3d across = stop->object_from_sensor.linear() * Eigen::Vector3d::UnitX();
    headings.push_back(std::atan2(across.y(), across.x()));
  }
  std::ranges::sort(headings);
  headings.push_back(headings.front() + 2 * std::numbers::pi);
  double widest = 0;
  for (std::size_t i = 1; i < headings.size(); ++i) {
    widest = std::max(widest, headings[i] - headings[i - 1]);
  }
  return widest;
}

/// The number of readings of all stops in each step of height.
std::vector<std::size_t> sum_heights(const Stops& stops) {
  std::vector<std::size_t> counts(stops.front()->heights.size());
  for (const ScanCheck::Stop* stop : stops) {
    std::ranges::transform(counts, stop->heights, counts.begin(), std::plus<>());
  }
  return counts;
}

/// The mean height of the readings around the most frequent height near z = 0, metres.
std::optional<double> find_platform(const std::vector<std::size_t>& counts, std::size_t stops) {
  std::size_t best = 0;
  std::size_t best_count = 0;
  for (std::size_t first = 0; first + height_window <= counts.size(); ++first) {
    const auto begin = counts.begin() + static_cast<std::ptrdiff_t>(first);
    const std::size_t count = std::accumulate(begin, begin + height_window, std::size_t{0});
    if (count > best_count) {
      best = first;
      best_count = count;
    }
  }
  if (best_count < min_platform_readings * stops) {
    return std::nullopt;
  }
  double sum = 0;
  for (std::size_t bin = best; bin < best + height_window; ++bin) {
    const double height =
        (static_cast<double>(bin) + 0.5) * ScanCheck::Stop::height_step - ScanCheck::Stop::highest;
    sum += height * static_cast<double>(counts[bin]);
  }
  return sum / static_cast<double>(best_count);
}

/// Finds what lies between the platform's noise and the box. The noise is as high above the
/// platform as below it, where nothing else is.
/// @param platform  metres
/// @param bottom    metres, of the box
BelowBox find_low_object(const std::vector<std::size_t>& counts, double platform, double bottom,
                         std::size_t stops) {
  constexpr double step = ScanCheck::Stop::height_step;
  const auto index = [](double height) {
    return static_cast<std::ptrdiff_t>(std::floor((height + ScanCheck::Stop::highest) / step));
  };
  const std::ptrdiff_t middle = index(platform);
  const auto size = static_cast<std::ptrdiff_t>(counts.size());
  const auto at = [&](std::ptrdiff_t bin) {
    return bin >= 0 && bin < size ? static_cast<double>(counts[static_cast<std::size_t>(bin)])
                                  : 0.0;
  };
  std::ptrdiff_t end = 2;
  while (end < middle && at(middle - end) > noise_share * at(middle)) {
    ++end;
  }
  double above = 0;
  for (std::ptrdiff_t by = end; middle + by < index(bottom); ++by) {
    above += at(middle + by) - at(middle - by);
  }
  return {.noise_end = platform + static_cast<double>(end) * step,
          .pixels = std::max(above, 0.0) * ScanCheck::Stop::thinning * ScanCheck::Stop::thinning /
                    static_cast<double>(stops)};
}

/// The hole above the object's highest readings at most stops, metres.
double find_unseen_top(const Stops& stops) {
  std::vector<double> holes;
  std::ranges::transform(stops, std::back_inserter(holes), &ScanCheck::Stop::unseen_top);
  std::ranges::sort(holes);
  return holes[static_cast<std::size_t>(share_without_hole * static_cast<double>(holes.size()))];
}

/// Centres of the cells in which more than one stop has readings, metres.
std::vector<Eigen::Vector3d> find_seen(const Stops& stops) {
  std::vector<const std::vector<ObjectCell>*> cells;
  std::ranges::transform(stops, std::back_inserter(cells),
                         [](const ScanCheck::Stop* stop) { return &stop->seen; });
  const std::vector<ObjectCell> several = cells_of_several(cells);
  std::vector<Eigen::Vector3d> seen;
  std::ranges::transform(several, std::back_inserter(seen), find_middle);
  return seen;
}

}  // namespace

ScanCheck::ScanCheck(const Box& clip, std::size_t stops, const SensorTraits& sensor)
    : clip_{.min = clip.min, .max = clip.max}, sensor_(sensor), stops_(stops) {}

ScanCheck::~ScanCheck() = default;

void ScanCheck::add(std::size_t stop, const Snapshot& snapshot) {
  stops_[stop] = std::make_unique<Stop>(snapshot, clip_);
}

std::vector<const ScanCheck::Stop*> ScanCheck::added() const {
  Stops stops;
  for (const auto& stop : stops_) {
    if (stop) {
      stops.push_back(stop.get());
    }
  }
  return stops;
}

std::optional<double> ScanCheck::lower_bottom() const {
  const Stops stops = added();
  if (stops.empty()) {
    return std::nullopt;
  }
  const std::vector<std::size_t> heights = sum_heights(stops);
  const std::optional<double> platform = find_platform(heights, stops.size());
  if (!platform) {
    return std::nullopt;
  }
  double inside = 0;
  for (const Stop* stop : stops) {
    inside += static_cast<double>(stop->object_pixels) / static_cast<double>(stops.size());
  }
  const BelowBox below = find_low_object(heights, *platform, clip_.min.z(), stops.size());
  const double bottom = std::ceil(below.possible_bottom() / bottom_step) * bottom_step;
  return below.has_most(inside) && bottom < clip_.min.z() ? std::optional(bottom) : std::nullopt;
}

ScanFigures ScanCheck::figures(int threads, std::span<const Eigen::Vector3d> leaves) const {
  const Stops stops = added();
  ScanFigures figures{.sensor = sensor_, .stops = stops.size()};
  if (stops.empty()) {
    return figures;
  }
  const auto count = static_cast<double>(stops.size());
  double depths = 0;
  std::array<Places, 5> cut;
  for (const Stop* stop : stops) {
    figures.object_pixels += static_cast<double>(stop->object_pixels) / count;
    depths += stop->depths / count;
    for (std::size_t side = 0; side < figures.cut_pixels.size(); ++side) {
      figures.cut_pixels[side] +=
          static_cast<double>(Stop::thinning) * static_cast<double>(stop->cut[side].size()) / count;
      for (const Eigen::Vector3f& point : stop->cut[side]) {
        cut[side].add(point.cast<double>());
      }
    }
  }
  std::ranges::transform(cut, figures.cut_places.begin(), &Places::centres);
  figures.distance = figures.object_pixels > 0 ? depths / figures.object_pixels : 0;
  figures.widest_gap = find_widest_gap(stops);
  const std::vector<std::size_t> heights = sum_heights(stops);
  figures.platform_height = find_platform(heights, stops.size());
  if (figures.platform_height) {
    figures.below = find_low_object(heights, *figures.platform_height, clip_.min.z(), stops.size());
  }
  figures.unseen_top = find_unseen_top(stops);
  figures.seen = find_seen(stops);
  figures.shell = compare_shell(stops, leaves);
  StopComparison comparison = compare_stops(stops, sensor_, threads);
  figures.disagreement = comparison.disagreement;
  figures.contradicted = std::move(comparison.contradicted);
  figures.differing = std::move(comparison.differing);
  return figures;
}

PoseChecks::PoseChecks(std::vector<Placement> placements, const Box& clip, std::size_t stops,
                       const SensorTraits& sensor)
    : placements_(std::move(placements)) {
  if (placements_.empty()) {
    placements_.push_back({.clip = clip});
  }
  for (const Placement& placement : placements_) {
    checks_.push_back(std::make_unique<ScanCheck>(placement.clip, stops, sensor));
  }
}

void PoseChecks::add(std::size_t stop, const Snapshot& snapshot) {
  const auto pose = static_cast<std::size_t>(snapshot.pose);
  if (placements_[pose].object_from_platform.matrix().isIdentity(0)) {
    checks_[pose]->add(stop, snapshot);
    return;
  }
  Snapshot seen = snapshot;
  seen.object_from_sensor =
      placements_[pose].object_from_platform.inverse() * snapshot.object_from_sensor;
  checks_[pose]->add(stop, seen);
}

std::vector<ScanFigures> PoseChecks::figures(int threads,
                                             std::span<const Eigen::Vector3d> leaves) const {
  std::vector<ScanFigures> all;
  for (std::size_t pose = 0; pose < checks_.size(); ++pose) {
    ScanFigures figures =
        checks_[pose]->figures(threads, pose == 0 ? leaves : std::span<const Eigen::Vector3d>());
    const auto move = [&](std::vector<Eigen::Vector3d>& places) {
      for (Eigen::Vector3d& place : places) {
        place = placements_[pose].object_from_platform * place;
      }
    };
    std::ranges::for_each(figures.cut_places, move);
    move(figures.differing.disagreeing);
    move(figures.differing.contradicted);
    move(figures.seen);
    all.push_back(std::move(figures));
  }
  return all;
}

std::optional<double> PoseChecks::lower_bottom() const {
  return checks_.size() == 1 ? checks_.front()->lower_bottom() : std::nullopt;
}

SnapshotSource checked_snapshots(SnapshotSource snapshots, PoseChecks& checks) {
  const std::size_t count = snapshots.count;
  return {.count = count, .read = [&checks, read = std::move(snapshots.read)](std::size_t shot) {
            Snapshot snapshot = read(shot);
            checks.add(shot, snapshot);
            return snapshot;
          }};
}

}  // namespace octurn
