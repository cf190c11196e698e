#include "mesh/thumbnail.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>

#include "octurn/png.hpp"

namespace octurn {
namespace {

using Eigen::Vector2f;
using Eigen::Vector3f;

constexpr int side = 256;
constexpr int fineness = 2;  // samples of a pixel along each axis
constexpr int samples = side * fineness;
constexpr float margin = 0.06F;  // of the side, around the model

// Directions from the model to the eye and to the lamp, in the model's frame, as in
// web/model/viewer.js and web/model/light.js.
const Vector3f to_eye = Vector3f(0.42F, -0.83F, 0.37F).normalized();
const Vector3f to_lamp = Vector3f(-0.66F, -0.46F, 0.7F).normalized();
constexpr std::array clay{216.0F, 210.0F, 196.0F};
// Shares of the light on a facet that faces the lamp: of the room, from all sides and more of it
// from above, and of the lamp.
constexpr float room = 0.38F;
constexpr float room_above = 0.18F;
constexpr float lamp = 0.5F;

constexpr float nothing = -std::numeric_limits<float>::infinity();

struct Sample {
  float depth = nothing;  // towards the eye
  float light = 0;
};

/// View matrix of an orthographic projection: its rows point right, up and to the eye in the
/// model's frame.
Eigen::Matrix3f make_view() {
  Eigen::Matrix3f view;
  const Vector3f right = Vector3f::UnitZ().cross(to_eye).normalized();
  view << right.transpose(), to_eye.cross(right).transpose(), to_eye.transpose();
  return view;
}

Vector3f to_vector(const std::array<float, 3>& corner) { return {corner[0], corner[1], corner[2]}; }

/// Lambertian shading of a facet, from 0.2 to about 1.
float light_on(const Vector3f& normal) {
  return room + room_above * normal.z() + lamp * std::max(normal.dot(to_lamp), 0.0F);
}

/// Twice the signed area of a triangle in the picture, positive if its corners are
/// counter-clockwise.
float area(const Vector3f& a, const Vector3f& b, const Vector3f& c) {
  return (b.x() - a.x()) * (c.y() - a.y()) - (b.y() - a.y()) * (c.x() - a.x());
}

/// Rasterizes triangles with a depth buffer.
class Canvas {
 public:
  /// @param box  around the model, in the view's frame
  explicit Canvas(const Eigen::AlignedBox3f& box) : middle_(box.center()) {
    const float width = std::max(box.sizes().x(), box.sizes().y());
    scale_ = width > 0 ? (1 - 2 * margin) * samples / width : 1;
  }

  void draw(const Facet& facet) {
    const auto packed = facet.corners;  // a copy: a facet's members are not aligned
    std::array<Vector3f, 3> corners;
    for (std::size_t i = 0; i < 3; ++i) {
      corners[i] = place(packed[i]);
    }
    const float whole = area(corners[0], corners[1], corners[2]);
    if (!(whole > 0)) {
      return;  // back-facing, or seen edge-on
    }
    const auto normal = facet.normal;
    const float light = light_on(to_vector(normal));
    const auto [left, right] = range(corners, 0);
    const auto [low, high] = range(corners, 1);
    for (int y = low; y <= high; ++y) {
      for (int x = left; x <= right; ++x) {
        put(x, y, corners, whole, light);
      }
    }
  }

  const std::vector<Sample>& picture() const { return picture_; }

 private:
  /// A corner in samples from the picture's lower left corner, and its depth.
  Vector3f place(const std::array<float, 3>& corner) const {
    const Vector3f seen = (view_ * to_vector(corner) - middle_) * scale_;
    return {seen.x() + samples / 2.0F, seen.y() + samples / 2.0F, seen.z()};
  }

  /// The samples that a triangle may cover along an axis.
  static std::pair<int, int> range(const std::array<Vector3f, 3>& corners, int axis) {
    const auto [low, high] = std::minmax({corners[0][axis], corners[1][axis], corners[2][axis]});
    return {std::clamp(static_cast<int>(std::floor(low)), 0, samples - 1),
            std::clamp(static_cast<int>(std::ceil(high)), 0, samples - 1)};
  }

  void put(int x, int y, const std::array<Vector3f, 3>& corners, float whole, float light) {
    const Vector3f at(static_cast<float>(x) + 0.5F, static_cast<float>(y) + 0.5F, 0);
    const float a = area(corners[1], corners[2], at) / whole;
    const float b = area(corners[2], corners[0], at) / whole;
    const float c = 1 - a - b;
    const float depth = a * corners[0].z() + b * corners[1].z() + c * corners[2].z();
    Sample& sample = picture_[static_cast<std::size_t>(y) * samples + static_cast<std::size_t>(x)];
    if (std::min({a, b, c}) >= 0 && depth > sample.depth) {
      sample = {.depth = depth, .light = light};
    }
  }

  Eigen::Matrix3f view_ = make_view();
  Vector3f middle_;
  float scale_ = 1;
  std::vector<Sample> picture_ = std::vector<Sample>(std::size_t{samples} * samples);
};

std::uint8_t to_byte(float value) {
  return static_cast<std::uint8_t>(std::lround(std::clamp(value, 0.0F, 255.0F)));
}

/// A pixel as the mean of its samples; row 0 is the picture's top.
Rgba pixel(const std::vector<Sample>& picture, int x, int y) {
  float light = 0;
  int seen = 0;
  for (int part = 0; part < fineness * fineness; ++part) {
    const int row = samples - 1 - (y * fineness + part / fineness);
    const int column = x * fineness + part % fineness;
    const Sample& sample =
        picture[static_cast<std::size_t>(row) * samples + static_cast<std::size_t>(column)];
    if (sample.depth > nothing) {
      light += sample.light;
      ++seen;
    }
  }
  if (seen == 0) {
    return {};
  }
  light /= static_cast<float>(seen);
  return {to_byte(clay[0] * light), to_byte(clay[1] * light), to_byte(clay[2] * light),
          to_byte(255.0F * static_cast<float>(seen) / (fineness * fineness))};
}

}  // namespace

std::vector<std::byte> draw_thumbnail(const FacetFile& facets) {
  const Eigen::Matrix3f view = make_view();
  Eigen::AlignedBox3f box;
  facets.read([&](std::span<const Facet> block) {
    for (const Facet& facet : block) {
      const auto corners = facet.corners;  // a copy: a facet's members are not aligned
      for (const auto& corner : corners) {
        box.extend(view * to_vector(corner));
      }
    }
  });
  Canvas canvas(box);
  facets.read([&](std::span<const Facet> block) {
    for (const Facet& facet : block) {
      canvas.draw(facet);
    }
  });
  std::vector<Rgba> picture;
  picture.reserve(std::size_t{side} * side);
  for (int y = 0; y < side; ++y) {
    for (int x = 0; x < side; ++x) {
      picture.push_back(pixel(canvas.picture(), x, y));
    }
  }
  return encode_colour_png(side, side, picture);
}

}  // namespace octurn
