#include "depth/crop.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "depth/depth_limits.hpp"

namespace octurn {
namespace {

constexpr int margin = 4;  // pixels: what a sighting looks at beside one, and rounding
constexpr int grain =
    16;  // pixels, to which the window's corner is aligned, as are a sighting's bounds

/// Pixels from `first` up to but without `end`.
struct Span {
  double low = std::numeric_limits<double>::max();
  double high = std::numeric_limits<double>::lowest();

  void extend(double at) {
    low = std::min(low, at);
    high = std::max(high, at);
  }
  int first(int size) const {
    return static_cast<int>(std::clamp(low - margin, 0.0, static_cast<double>(size))) / grain *
           grain;
  }
  int end(int size) const {
    return static_cast<int>(std::ceil(std::clamp(high + margin, 0.0, static_cast<double>(size))));
  }
};

}  // namespace

Snapshot crop(const Snapshot& snapshot, const Box& box) {
  const auto& [frame, intrinsics, object_from_sensor] = snapshot;
  check_size(frame, intrinsics, "crop");
  const Eigen::Isometry3d sensor_from_object = object_from_sensor.inverse();
  Span u;
  Span v;
  for (int corner = 0; corner < 8; ++corner) {
    const Eigen::Vector3d p =
        sensor_from_object * Eigen::Vector3d((corner & 1 ? box.max : box.min).x(),
                                             (corner & 2 ? box.max : box.min).y(),
                                             (corner & 4 ? box.max : box.min).z());
    if (p.z() < nearest_z) {
      return snapshot;
    }
    u.extend(p.x() / p.z() * intrinsics.fx + intrinsics.cx);
    v.extend(p.y() / p.z() * intrinsics.fy + intrinsics.cy);
  }
  const int u0 = u.first(intrinsics.width);
  const int v0 = v.first(intrinsics.height);
  const int width = u.end(intrinsics.width) - u0;
  const int height = v.end(intrinsics.height) - v0;
  if (width <= 0 || height <= 0) {
    return snapshot;
  }
  Snapshot part{.frame = {.width = width, .height = height, .depth = {}},
                .intrinsics = intrinsics,
                .object_from_sensor = object_from_sensor};
  part.intrinsics.width = width;
  part.intrinsics.height = height;
  part.intrinsics.cx -= u0;
  part.intrinsics.cy -= v0;
  part.frame.depth.reserve(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  for (int row = v0; row < v0 + height; ++row) {
    const auto first =
        frame.depth.begin() + static_cast<std::ptrdiff_t>(row) * intrinsics.width + u0;
    part.frame.depth.insert(part.frame.depth.end(), first, first + width);
  }
  return part;
}

}  // namespace octurn
