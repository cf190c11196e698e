#include "depth/crop.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "depth/depth_limits.hpp"
#include "depth/pinhole.hpp"

namespace octurn {
namespace {

constexpr int margin = 4;      // pixels: three that conditioning reads, and one for rounding
constexpr int alignment = 16;  // pixels, of the window's corner: texels of a `DepthPyramid` stay
                               // those of the whole image

/// The pixels along one axis that points project to, with a margin.
struct PixelInterval {
  double min = std::numeric_limits<double>::max();
  double max = std::numeric_limits<double>::lowest();

  void extend(double at) {
    min = std::min(min, at);
    max = std::max(max, at);
  }
  int first(int size) const {
    return static_cast<int>(std::clamp(min - margin, 0.0, static_cast<double>(size))) / alignment *
           alignment;
  }
  int end(int size) const {
    return static_cast<int>(std::ceil(std::clamp(max + margin, 0.0, static_cast<double>(size))));
  }
};

}  // namespace

Snapshot crop(const Snapshot& snapshot, const Box& box) {
  const DepthFrame& frame = snapshot.frame;
  const Intrinsics& intrinsics = snapshot.intrinsics;
  check_size(frame, intrinsics, "crop");
  const Eigen::Isometry3d sensor_from_object = snapshot.object_from_sensor.inverse();
  PixelInterval u;
  PixelInterval v;
  for (int corner = 0; corner < 8; ++corner) {
    const Eigen::Vector3d p =
        sensor_from_object * Eigen::Vector3d((corner & 1 ? box.max : box.min).x(),
                                             (corner & 2 ? box.max : box.min).y(),
                                             (corner & 4 ? box.max : box.min).z());
    if (p.z() < nearest_z) {
      return snapshot;
    }
    const Eigen::Vector2d pixel = project(intrinsics, p);
    u.extend(pixel.x());
    v.extend(pixel.y());
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
                .object_from_sensor = snapshot.object_from_sensor,
                .pose = snapshot.pose};
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
