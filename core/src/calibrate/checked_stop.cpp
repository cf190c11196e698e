#include "calibrate/checked_stop.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "depth/depth_limits.hpp"
#include "depth/pinhole.hpp"
#include "octurn/median.hpp"

namespace octurn {

ObjectCell to_object_cell(const Eigen::Vector3d& point) {
  const Eigen::Vector3d cell = (point / object_cell_side).array().floor();
  return {static_cast<std::int16_t>(cell.x()), static_cast<std::int16_t>(cell.y()),
          static_cast<std::int16_t>(cell.z())};
}

Eigen::Vector3d find_middle(const ObjectCell& cell) {
  return object_cell_side * Eigen::Vector3d(cell[0] + 0.5, cell[1] + 0.5, cell[2] + 0.5);
}

std::vector<ObjectCell> cells_of_several(std::span<const std::vector<ObjectCell>* const> stops) {
  std::vector<ObjectCell> all;
  for (const std::vector<ObjectCell>* stop : stops) {
    all.insert(all.end(), stop->begin(), stop->end());
  }
  std::ranges::sort(all);
  std::vector<ObjectCell> several;
  for (std::size_t i = 1; i < all.size(); ++i) {
    if (all[i] == all[i - 1] && (several.empty() || several.back() != all[i])) {
      several.push_back(all[i]);
    }
  }
  return several;
}

namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

constexpr int thinning = ScanCheck::Stop::thinning;
constexpr std::size_t pixels_for_one = std::size_t{thinning} * thinning;  // for each one kept
// Pixels for which a point of a line counts: the spacing of lines of neighbouring stops.
constexpr std::size_t pixels_of_line = 4;
constexpr int depth_block_side = 4;        // kept rows and columns to a side
constexpr double compared_readings = 400;  // of a stop, to compare
constexpr double platform_radius = 0.13;   // metres, in which heights are counted
constexpr double max_cut_step = 0.01;      // metres between neighbours of one surface
constexpr double min_cut_height =
    0.01;  // metres above the box's bottom: the platform's rim is lower
// A reading belongs to a surface if at least `min_beside` of its eight neighbours continue it, with
// a slope of at most 74 degrees. Mixed readings at depth edges have fewer such neighbours.
constexpr int min_beside = 5;
constexpr double max_slope_step = 0.012;  // share of the depth, over two pixels
constexpr int top_rows = 3;               // kept rows that belong to the object's top
constexpr std::size_t min_top_columns = 3;
constexpr int beside_columns = 10;  // kept columns beside the top, where its hole has ended

/// The intrinsics of an image whose pixels are blocks of `size` x `size` pixels of another.
Intrinsics merged(Intrinsics lens, int size) {
  lens.width /= size;
  lens.height /= size;
  lens.fx /= size;
  lens.fy /= size;
  const double corner = (size - 1) / 2.0;  // from a block's first pixel to its middle
  lens.cx = (lens.cx - corner) / size;
  lens.cy = (lens.cy - corner) / size;
  return lens;
}

/// Every other row and column of a depth image. Strips have none: their image is empty.
Snapshot thinned(const Snapshot& snapshot) {
  if (!snapshot.strips.empty()) {
    Snapshot none{.intrinsics = snapshot.intrinsics,
                  .object_from_sensor = snapshot.object_from_sensor};
    none.intrinsics.width = 0;
    none.intrinsics.height = 0;
    return none;
  }
  const DepthFrame& frame = snapshot.frame;
  const Intrinsics& lens = snapshot.intrinsics;
  check_size(frame, lens, "ScanCheck");
  Snapshot thin{.frame = {.width = (frame.width + thinning - 1) / thinning,
                          .height = (frame.height + thinning - 1) / thinning,
                          .depth = {}},
                .intrinsics = lens,
                .object_from_sensor = snapshot.object_from_sensor};
  thin.intrinsics.width = thin.frame.width;
  thin.intrinsics.height = thin.frame.height;
  thin.intrinsics.fx /= thinning;
  thin.intrinsics.fy /= thinning;
  thin.intrinsics.cx /= thinning;
  thin.intrinsics.cy /= thinning;
  for (int v = 0; v < frame.height; v += thinning) {
    const auto row = frame.depth.begin() + static_cast<std::ptrdiff_t>(v) * frame.width;
    for (int u = 0; u < frame.width; u += thinning) {
      thin.frame.depth.push_back(row[u]);
    }
  }
  return thin;
}

/// The side of the box that lies between a point inside and one outside, numbered as
/// `ScanFigures::cut_pixels`; 5 is the bottom.
std::size_t side_between(const Box& box, const Vector3d& outside) {
  for (const int axis : {2, 0, 1}) {
    if (outside[axis] > box.max[axis]) {
      return axis == 2 ? 4 : static_cast<std::size_t>(2 * axis + 1);
    }
    if (outside[axis] < box.min[axis]) {
      return axis == 2 ? 5 : static_cast<std::size_t>(2 * axis);
    }
  }
  return 5;
}

constexpr std::array<std::array<int, 2>, 4> next_to = {{{-1, 0}, {1, 0}, {0, -1}, {0, 1}}};

/// The points of a depth image, in the object's frame.
class Points {
 public:
  explicit Points(const Snapshot& snapshot) : snapshot_(snapshot) {}

  double depth(int u, int v) const {
    const DepthFrame& frame = snapshot_.frame;
    return frame.depth[static_cast<std::size_t>(v) * static_cast<std::size_t>(frame.width) +
                       static_cast<std::size_t>(u)] *
           snapshot_.intrinsics.depth_unit;
  }
  Vector3d at(int u, int v) const {
    return snapshot_.object_from_sensor * (to_ray(snapshot_.intrinsics, u, v) * depth(u, v));
  }

 private:
  const Snapshot& snapshot_;
};

/// Adds a point once for each neighbour in the picture from which the box cuts it off.
/// @param inside  metres, object's frame, of the pixel (u, v)
/// @param cut     as `ScanCheck::Stop::cut`
void add_cuts(const Points& points, const Box& clip, const Vector3d& inside, int u, int v,
              std::array<std::vector<Eigen::Vector3f>, 5>& cut) {
  if (inside.z() < clip.min.z() + min_cut_height) {
    return;
  }
  for (const auto& [du, dv] : next_to) {
    const double depth = points.depth(u + du, v + dv);
    const Vector3d other = points.at(u + du, v + dv);
    if (!(depth > nearest_z) || std::abs(depth - points.depth(u, v)) > max_cut_step ||
        contains(clip, other)) {
      continue;
    }
    const std::size_t side = side_between(clip, other);
    if (side < cut.size()) {
      cut[side].emplace_back(inside.cast<float>());
    }
  }
}

/// Whether most of the eight neighbours of a pixel lie on its surface.
bool is_of_a_surface(const Points& points, int u, int v, double z) {
  int beside = -1;  // the pixel itself is counted, too
  for (int row = -1; row <= 1; ++row) {
    for (int column = -1; column <= 1; ++column) {
      beside += std::abs(points.depth(u + column, v + row) - z) < max_slope_step * z ? 1 : 0;
    }
  }
  return beside >= min_beside;
}

/// The smallest depth in each block, metres; 0 if one of its pixels has none.
std::vector<float> nearest_in_blocks(const Points& points, const Intrinsics& lens) {
  std::vector<float> nearest;
  for (int v = 0; v < lens.height; ++v) {
    for (int u = 0; u < lens.width; ++u) {
      double min = points.depth(u * depth_block_side, v * depth_block_side);
      for (int i = 0; i < depth_block_side * depth_block_side; ++i) {
        min = std::min(min, points.depth(u * depth_block_side + i % depth_block_side,
                                         v * depth_block_side + i / depth_block_side));
      }
      nearest.push_back(static_cast<float>(min));
    }
  }
  return nearest;
}

/// Whether most pixels of a part of a row have readings.
bool is_read(const Points& points, const Intrinsics& lens, int v, int from, int to) {
  int read = 0;
  for (int u = std::max(from, 0); u < std::min(to, lens.width); ++u) {
    read += points.depth(u, v) > nearest_z ? 1 : 0;
  }
  return 2 * read > to - from;
}

/// Measures a hole in the readings above the object's highest ones: it begins there in most
/// columns, and ends at something behind, which is also read beside it. Edges and shadows of the
/// projector make no such holes.
/// @param tops  for each column the row of the object's highest reading; the image's height: none
/// @return metres at the object's distance; 0 if there is none
double measure_hole(const Points& points, const Intrinsics& lens, const std::vector<int>& tops) {
  const auto highest = std::ranges::min_element(tops);
  if (highest == tops.end() || *highest >= lens.height) {
    return 0;
  }
  std::vector<int> rows;
  int first = lens.width;
  int last = 0;
  for (int u = 0; u < lens.width; ++u) {
    const int top = tops[static_cast<std::size_t>(u)];
    if (top > *highest + top_rows) {
      continue;
    }
    int v = top - 1;
    while (v >= 0 && !(points.depth(u, v) > nearest_z)) {
      --v;
    }
    rows.push_back(v < 0 ? 0 : top - 1 - v);
    first = std::min(first, u);
    last = u;
  }
  const auto hole = static_cast<int>(median(rows));
  const int middle = *highest - hole / 2;
  const bool is_read_beside =
      is_read(points, lens, middle, first - 2 * beside_columns, first - beside_columns) ||
      is_read(points, lens, middle, last + beside_columns, last + 2 * beside_columns);
  const auto column = static_cast<int>(highest - tops.begin());
  return rows.size() < min_top_columns || !is_read_beside
             ? 0
             : hole * points.depth(column, *highest) / lens.fy;
}

void keep_each_once(std::vector<ObjectCell>& cells) {
  std::ranges::sort(cells);
  cells.erase(std::unique(cells.begin(), cells.end()), cells.end());
  cells.shrink_to_fit();
}

}  // namespace

ScanCheck::Stop::Stop(const Snapshot& snapshot, const Box& clip)
    : Stop(thinned(snapshot), clip, make_mask(snapshot.object_from_sensor)) {
  for (const LineStrip& strip : snapshot.strips) {
    add_line(strip, clip);
  }
  keep_each_once(seen);
}

/// Adds the points of a line. They are not compared with other stops, which see other lines.
void ScanCheck::Stop::add_line(const LineStrip& strip, const Box& clip) {
  const Eigen::Isometry3d sensor_from_object = object_from_sensor.inverse();
  std::optional<Vector3d> before;  // the point in the row above
  for (std::size_t i = 0; i < strip.own_points; ++i) {
    const Vector3d point = strip.points[i].cast<double>();
    if (!point.allFinite()) {
      continue;
    }
    add_height(point, pixels_of_line);
    const bool is_inside = contains(clip, point);
    if (is_inside) {
      object_pixels += pixels_of_line;
      depths += (sensor_from_object * point).z() * static_cast<double>(pixels_of_line);
      seen.push_back(to_object_cell(point));
    }
    if (before && (point - *before).norm() < max_cut_step && contains(clip, *before) != is_inside) {
      const Vector3d& inside = is_inside ? point : *before;
      const std::size_t side = side_between(clip, is_inside ? *before : point);
      if (side < cut.size() && inside.z() > clip.min.z() + min_cut_height) {
        cut[side].emplace_back(inside.cast<float>());
      }
    }
    before = point;
  }
}

void ScanCheck::Stop::add_height(const Vector3d& point, std::size_t count) {
  if (std::abs(point.z()) < highest && point.head<2>().norm() < platform_radius) {
    heights[static_cast<std::size_t>((point.z() + highest) / height_step)] += count;
  }
}

ScanCheck::Stop::Stop(const Snapshot& thin, const Box& clip, const ObjectView::Mask& mask)
    : object_from_sensor(thin.object_from_sensor),
      blocks{.lens = merged(thin.intrinsics, depth_block_side)},
      view(thin.frame, thin.intrinsics, mask),
      heights(static_cast<std::size_t>(std::lround(2 * highest / height_step))) {
  const Points points(thin);
  blocks.nearest = nearest_in_blocks(points, blocks.lens);
  std::vector<int> tops(static_cast<std::size_t>(thin.frame.width), thin.frame.height);
  for (int v = 1; v + 1 < thin.frame.height; ++v) {
    for (int u = 1; u + 1 < thin.frame.width; ++u) {
      const double z = points.depth(u, v);
      if (!(z > nearest_z)) {
        continue;
      }
      const Vector3d point = points.at(u, v);
      add_height(point, 1);
      if (contains(clip, point)) {
        object_pixels += pixels_for_one;
        depths += z * static_cast<double>(pixels_for_one);
        if (is_of_a_surface(points, u, v, z)) {
          seen.push_back(to_object_cell(point));
          int& top = tops[static_cast<std::size_t>(u)];
          top = std::min(top, v);
        }
        add_cuts(points, clip, point, u, v, cut);
      }
    }
  }
  unseen_top = measure_hole(points, thin.intrinsics, tops);
  keep_each_once(seen);
  const int step = std::max(1, static_cast<int>(std::sqrt(view.pixels() / compared_readings)));
  readings = view.readings(step);
  std::erase_if(readings, [&](const SurfaceReading& reading) {
    return !contains(clip, object_from_sensor * reading.point);
  });
}

double ScanCheck::Stop::empty_depth(const Vector3d& point) const {
  if (!(point.z() > nearest_z)) {
    return 0;
  }
  const Eigen::Vector2d pixel = project(blocks.lens, point);
  const double u = pixel.x();
  const double v = pixel.y();
  if (!(u >= 1 && v >= 1 && u < blocks.lens.width - 2 && v < blocks.lens.height - 2)) {
    return 0;
  }
  float nearest = std::numeric_limits<float>::max();
  for (int row = -1; row <= 1; ++row) {
    for (int column = -1; column <= 1; ++column) {
      const auto at = static_cast<std::size_t>((std::lround(v) + row) * blocks.lens.width +
                                               std::lround(u) + column);
      nearest = std::min(nearest, blocks.nearest[at]);
    }
  }
  return static_cast<double>(nearest);
}

}  // namespace octurn
