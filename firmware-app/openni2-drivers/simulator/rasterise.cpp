#include "simulator/rasterise.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace octurn {
namespace {

using Eigen::Vector3f;

constexpr float nearest = 0.05F;  // distance of the near plane, metres

/// A triangle's corner on the picture: u, v and inverse depth.
using Corner = Vector3f;

/// Twice the area of a triangle, positive if it turns clockwise on the picture (v is down).
float area(const Corner& a, const Corner& b, float u, float v) {
  return (b.x() - a.x()) * (v - a.y()) - (b.y() - a.y()) * (u - a.x());
}

class Canvas {
 public:
  Canvas(const Intrinsics& intrinsics, InverseDepth& picture)
      : width_(intrinsics.width),
        height_(intrinsics.height),
        focal_(static_cast<float>(intrinsics.fx), static_cast<float>(intrinsics.fy)),
        centre_(static_cast<float>(intrinsics.cx), static_cast<float>(intrinsics.cy)),
        picture_(picture) {}

  Corner project(const Vector3f& point) const {
    const float inverse = 1 / point.z();
    return {focal_.x() * point.x() * inverse + centre_.x(),
            focal_.y() * point.y() * inverse + centre_.y(), inverse};
  }

  /// Draws the part of a triangle that lies in front of the near plane.
  void draw_cut(const std::array<Vector3f, 3>& points) {
    std::array<Vector3f, 4> inside;
    std::size_t count = 0;
    for (std::size_t i = 0; i < 3; ++i) {
      const Vector3f& from = points[i];
      const Vector3f& to = points[(i + 1) % 3];
      if (from.z() > nearest) {
        inside[count++] = from;
      }
      if ((from.z() > nearest) != (to.z() > nearest)) {
        inside[count++] = from + (to - from) * ((nearest - from.z()) / (to.z() - from.z()));
      }
    }
    for (std::size_t i = 2; i < count; ++i) {
      draw(project(inside[0]), project(inside[i - 1]), project(inside[i]));
    }
  }

  void draw(const Corner& a, Corner b, Corner c) {
    const Corner min = a.cwiseMin(b).cwiseMin(c);
    const Corner max = a.cwiseMax(b).cwiseMax(c);
    const int first_u = first_from(min.x(), width_);
    const int end_u = end_after(max.x(), width_);
    const int first_v = first_from(min.y(), height_);
    const int end_v = end_after(max.y(), height_);
    if (first_u >= end_u || first_v >= end_v) {
      return;  // small triangles mostly lie between the centres of pixels
    }
    float whole = area(a, b, c.x(), c.y());
    if (whole < 0) {
      std::swap(b, c);
      whole = -whole;
    }
    if (whole < smallest) {
      return;
    }
    const float slope_b = (b.z() - a.z()) / whole;
    const float slope_c = (c.z() - a.z()) / whole;
    for (int v = first_v; v < end_v; ++v) {
      float* row = picture_.data() + static_cast<std::ptrdiff_t>(v) * width_;
      for (int u = first_u; u < end_u; ++u) {
        const auto x = static_cast<float>(u);
        const auto y = static_cast<float>(v);
        const float over_a = area(b, c, x, y);
        const float over_b = area(c, a, x, y);
        const float over_c = area(a, b, x, y);
        if (std::min({over_a, over_b, over_c}) >= -slack) {
          const float inverse = a.z() + over_b * slope_b + over_c * slope_c;
          row[u] = std::max(row[u], std::clamp(inverse, min.z(), max.z()));
        }
      }
    }
  }

 private:
  static constexpr float smallest =
      1e-7F;                             // square pixels; twice the area of a degenerate triangle
  static constexpr float slack = 1e-3F;  // square pixels: rounding must not open seams

  /// The first pixel whose centre is not before `min`.
  static int first_from(float min, int size) {
    const float inside = std::clamp(min, 0.0F, static_cast<float>(size));
    const int whole = static_cast<int>(inside);
    return static_cast<float>(whole) < inside ? whole + 1 : whole;
  }

  /// One past the last pixel whose centre is not after `max`.
  static int end_after(float max, int size) {
    return static_cast<int>(std::clamp(max + 1, 0.0F, static_cast<float>(size)));
  }

  int width_;
  int height_;
  Eigen::Vector2f focal_;
  Eigen::Vector2f centre_;
  InverseDepth& picture_;
};

}  // namespace

void rasterise(const Mesh& mesh, const Eigen::Isometry3d& sensor_from_mesh,
               const Intrinsics& intrinsics, InverseDepth& picture) {
  assert(picture.size() ==
         static_cast<std::size_t>(intrinsics.width) * static_cast<std::size_t>(intrinsics.height));
  Canvas canvas(intrinsics, picture);
  const Eigen::Isometry3f pose = sensor_from_mesh.cast<float>();
  std::vector<Vector3f> points(mesh.vertices.size());
  std::vector<Corner> corners(mesh.vertices.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    points[i] = pose * mesh.vertices[i];
    corners[i] = canvas.project(points[i]);
  }
  for (const auto& [a, b, c] : mesh.triangles) {
    if (std::min({points[a].z(), points[b].z(), points[c].z()}) > nearest) {
      canvas.draw(corners[a], corners[b], corners[c]);
    } else {
      canvas.draw_cut({points[a], points[b], points[c]});
    }
  }
}

}  // namespace octurn
