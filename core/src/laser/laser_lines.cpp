#include "laser/laser_lines.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <span>
#include <string>
#include <utility>

#include "io/sensor_json.hpp"
#include "laser/line_strip.hpp"

namespace octurn {
namespace {

// Lines are joined with others at least this many pixels away on an object of 8 cm. A real line is
// known to half a pixel, so that triangles between nearer ones have random planes: of a real scan
// whose lines were 2.3 pixels apart, 64 % of the model was seen with every second line, and 44 %
// with the next.
constexpr double min_spacing_pixels = 2.5;
constexpr double object_radius = 0.04;  // metres

/// The width that `LaserLines::pixel` returns.
double pixel_at_object(const Scan& scan) {
  const Box clip = model_clip(scan);
  const Eigen::Vector3d middle = (clip.min + clip.max) / 2;
  const Eigen::Vector3d seen =
      model_pose(scan, scan.shots.front()).inverse() * Eigen::Vector3d(middle.x(), middle.y(), 0);
  return std::max(seen.norm(), 0.05) / scan.intrinsics.fx;
}

Picture read_picture(const std::filesystem::path& folder, const std::string& file,
                     const Intrinsics& lens) {
  const std::string png = read_scan_file(folder / file);
  return decode_picture_png(file, std::as_bytes(std::span(png)), lens.width, lens.height);
}

const std::optional<SolvedPose>& find_solved_pose(const Scan& scan, const Shot& shot) {
  return scan.poses.empty() ? scan.solved : scan.poses[static_cast<std::size_t>(shot.pose)].solved;
}

}  // namespace

LaserLines::LaserLines(std::filesystem::path folder, Scan scan)
    : scan_(std::move(scan)),
      folder_(std::move(folder)),
      pixel_(pixel_at_object(scan_)),
      scale_(line_scale(pixel_)),
      stops_(std::make_unique<Stop[]>(scan_.shots.size())) {
  const double min_turn = min_spacing_pixels * pixel_ / object_radius;
  for (std::size_t stop = 0; stop < scan_.shots.size(); ++stop) {
    neighbours_.push_back({.previous = neighbour(stop, scan_.shots.size() - 1, min_turn),
                           .next = neighbour(stop, 1, min_turn)});
  }
}

/// The first stop of the same pose in a direction that is turned by at least `min_turn`; where
/// there is none, the next one.
/// @param step  1: forwards; the number of stops less one: backwards
std::size_t LaserLines::neighbour(std::size_t stop, std::size_t step, double min_turn) const {
  const std::size_t count = scan_.shots.size();
  const auto turn_to = [&](std::size_t other) {
    return std::abs(
        std::remainder(scan_.shots[other].angle - scan_.shots[stop].angle, 2 * std::numbers::pi));
  };
  std::size_t nearest = stop;
  for (std::size_t other = (stop + step) % count; other != stop; other = (other + step) % count) {
    if (scan_.shots[other].pose == scan_.shots[stop].pose) {
      nearest = nearest == stop ? other : nearest;
      if (turn_to(other) >= min_turn) {
        return other;
      }
    }
  }
  return nearest;
}

std::size_t LaserLines::expected_bytes(const Scan& scan) {
  const auto rows = static_cast<std::size_t>(scan.intrinsics.height);
  const std::size_t of_line = rows * (sizeof(LineProfile::Ray) + sizeof(std::int32_t));
  return scan.shots.size() * scan.laser->lasers.size() * of_line;
}

const std::vector<LineProfile>& LaserLines::at(std::size_t stop) const {
  Stop& kept = stops_[stop];
  std::call_once(kept.read, [&] {
    const Intrinsics& lens = scan_.intrinsics;
    const std::vector<std::string>& files = scan_.shots[stop].pictures;
    const Picture dark = read_picture(folder_, files.front(), lens);
    for (std::size_t laser = 1; laser < files.size(); ++laser) {
      const Picture lit = read_picture(folder_, files[laser], lens);
      kept.lines.push_back(to_profile(find_line(dark, lit, scale_), lens, *scan_.laser));
    }
  });
  return kept.lines;
}

Snapshot LaserLines::snapshot(std::size_t stop) const {
  const Shot& shot = scan_.shots[stop];
  const std::vector<Laser> lasers = model_lasers(*scan_.laser, find_solved_pose(scan_, shot));
  Snapshot snapshot{.intrinsics = scan_.intrinsics,
                    .object_from_sensor = model_pose(scan_, shot),
                    .pose = shot.pose};
  const auto line = [&](std::size_t of, std::size_t laser) -> PlacedLine {
    return {.profile = at(of)[laser],
            .laser = lasers[laser],
            .object_from_sensor = model_pose(scan_, scan_.shots[of])};
  };
  const auto [previous, next] = neighbours_[stop];
  for (std::size_t laser = 0; laser < lasers.size(); ++laser) {
    const PlacedLine before = line(previous, laser);
    const PlacedLine after = line(next, laser);
    snapshot.strips.push_back(make_strip(line(stop, laser), previous != stop ? &before : nullptr,
                                         next != stop ? &after : nullptr));
  }
  return snapshot;
}

}  // namespace octurn
