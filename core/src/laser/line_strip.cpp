#include "laser/line_strip.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <span>
#include <string>
#include <utility>

#include "io/sensor_json.hpp"
#include "octurn/light_channel.hpp"

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

/// A picture's file: greyscale, or in colour.
class PictureFile {
 public:
  PictureFile(const std::filesystem::path& folder, const std::string& file, const Intrinsics& lens)
      : name_(file), png_(read_scan_file(folder / file)), lens_(lens) {
    if (has_colours()) {
      colours_ = decode_rgb_png(name_, std::as_bytes(std::span(png_)), lens_.width, lens_.height);
    }
  }

  const std::optional<ColourPicture>& colours() const { return colours_; }

  Picture in(Channel channel) const {
    return colours_ ? to_picture(*colours_, channel)
                    : decode_picture_png(name_, std::as_bytes(std::span(png_)), lens_.width,
                                         lens_.height);
  }

 private:
  /// The 26th byte of a PNG, in its IHDR chunk, is the colour type.
  bool has_colours() const {
    constexpr std::size_t kind_at = 25;
    constexpr char truecolour = 2;
    return png_.size() > kind_at && png_[kind_at] == truecolour;
  }

  std::string name_;
  std::string png_;
  const Intrinsics& lens_;
  std::optional<ColourPicture> colours_ = {};
};

/// The channel in which two pictures show a laser. A greyscale one has nothing but luminance.
Channel channel_of(const PictureFile& dark, const PictureFile& lit) {
  return dark.colours() && lit.colours() ? find_channel(*dark.colours(), *lit.colours())
                                         : Channel::luminance;
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
    const PictureFile dark(folder_, files.front(), lens);
    Channel seen = Channel::luminance;  // in the dark picture
    Picture without = dark.in(seen);
    for (std::size_t laser = 1; laser < files.size(); ++laser) {
      const PictureFile lit(folder_, files[laser], lens);
      const Channel channel = channel_of(dark, lit);
      if (channel != seen) {
        without = dark.in(channel);
        seen = channel;
      }
      kept.lines.push_back(
          to_profile(find_line(without, lit.in(channel), scale_), lens, *scan_.laser));
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

namespace {

using Eigen::Vector3d;

constexpr double max_row_side = 0.0025;     // metres, between neighbouring rows of one line
constexpr double gap = 0.0015;              // metres, besides the platform's motion there
constexpr double max_triangle_side = 0.01;  // metres, for any number of stops

/// A line's points in the optical frame of the stop whose strip is made, in the order of its rays.
std::vector<Vector3d> to_points(const PlacedLine& line, const Eigen::Isometry3d& own_from_line) {
  std::vector<Vector3d> points;
  points.reserve(line.profile.rays.size());
  for (const LineProfile::Ray& ray : line.profile.rays) {
    points.push_back(own_from_line * meet(ray, line.laser));
  }
  return points;
}

double column(const Vector3d& point) { return point.x() / point.z(); }

/// Joins a stop's line with that of a neighbouring stop.
class LineJoiner {
 public:
  /// @param first  index of the other line's first point in the strip
  LineJoiner(const PlacedLine& own, const std::vector<Vector3d>& own_points,
             const PlacedLine& other, std::size_t first)
      : own_(own.profile),
        other_(other.profile),
        own_points_(own_points),
        own_from_other_(own.object_from_sensor.inverse() * other.object_from_sensor),
        other_points_(to_points(other, own_from_other_)),
        first_(first) {}

  const std::vector<Vector3d>& other_points() const { return other_points_; }

  std::vector<LineStrip::Triangle> triangles() const {
    std::vector<LineStrip::Triangle> triangles;
    for (std::size_t v = 0; v + 1 < own_.rows.size(); ++v) {
      for (auto i = own_.rows[v]; i < own_.rows[v + 1]; ++i) {
        if (own_.rays[static_cast<std::size_t>(i)].next >= 0) {
          join(static_cast<std::size_t>(i), v, triangles);
        }
      }
    }
    return triangles;
  }

 private:
  struct Limits {
    double side = 0;     // metres, of a triangle
    double towards = 0;  // change of the column of a point that moves with the platform
  };

  Limits limits_at(const Vector3d& point) const {
    const Vector3d turned = own_from_other_ * point;
    return {.side = std::min(gap + (turned - point).norm(), max_triangle_side),
            .towards = column(turned) - column(point)};
  }

  static bool near(const Vector3d& a, const Vector3d& b, double max) {
    return (a - b).squaredNorm() <= max * max;
  }

  bool joins(const Vector3d& own, const Vector3d& other, const Limits& limits) const {
    return near(own, other, limits.side) && (column(other) - column(own)) * limits.towards > 0;
  }

  /// Index of the other line's nearest point in row `v` that can be joined with `own`, or -1.
  std::int32_t match(const Vector3d& own, std::size_t v, const Limits& limits) const {
    std::int32_t best = -1;
    double best_square = limits.side * limits.side;
    for (auto j = other_.rows[v]; j < other_.rows[v + 1]; ++j) {
      const Vector3d& other = other_points_[static_cast<std::size_t>(j)];
      const double square = (own - other).squaredNorm();
      if (square < best_square && joins(own, other, limits)) {
        best = j;
        best_square = square;
      }
    }
    return best;
  }

  void join(std::size_t i, std::size_t v, std::vector<LineStrip::Triangle>& triangles) const {
    const auto below = static_cast<std::size_t>(own_.rays[i].next);
    const Vector3d& a = own_points_[i];
    const Vector3d& b = own_points_[below];
    const Limits limits = limits_at(a);
    const std::int32_t matched = match(a, v, limits);
    if (matched < 0) {
      return;
    }
    const auto j = static_cast<std::size_t>(matched);
    const Vector3d& c = other_points_[j];
    if (!joins(b, c, limits)) {
      return;
    }
    const auto at = [this](std::size_t point) {
      return static_cast<std::uint32_t>(first_ + point);
    };
    const auto own_at = [](std::size_t point) { return static_cast<std::uint32_t>(point); };
    if (near(a, b, max_row_side)) {
      triangles.push_back({own_at(i), own_at(below), at(j)});
    }
    if (const std::int32_t next = other_.rays[j].next; next >= 0) {
      const Vector3d& d = other_points_[static_cast<std::size_t>(next)];
      if (near(c, d, max_row_side) && joins(b, d, limits)) {
        triangles.push_back({own_at(below), at(static_cast<std::size_t>(next)), at(j)});
      }
    }
  }

  const LineProfile& own_;
  const LineProfile& other_;
  const std::vector<Vector3d>& own_points_;
  Eigen::Isometry3d own_from_other_;
  std::vector<Vector3d> other_points_;
  std::size_t first_;
};

}  // namespace

LineStrip make_strip(const PlacedLine& own, const PlacedLine* previous, const PlacedLine* next) {
  const std::vector<Vector3d> own_points = to_points(own, Eigen::Isometry3d::Identity());
  LineStrip strip{.own_points = own_points.size()};
  const auto append = [&](const std::vector<Vector3d>& points) {
    for (const Vector3d& point : points) {
      strip.points.emplace_back((own.object_from_sensor * point).cast<float>());
    }
  };
  append(own_points);
  const auto join = [&](const PlacedLine* other) -> std::vector<LineStrip::Triangle> {
    if (other == nullptr) {
      return {};
    }
    const LineJoiner joiner(own, own_points, *other, strip.points.size());
    append(joiner.other_points());
    return joiner.triangles();
  };
  strip.to_previous = join(previous);
  strip.to_next = join(next);
  if (own.laser.source) {
    strip.source = own.object_from_sensor * *own.laser.source;
  }
  return strip;
}

}  // namespace octurn
