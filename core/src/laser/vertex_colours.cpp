#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>

#include "depth/pinhole.hpp"
#include "io/radial_distortion.hpp"
#include "io/sensor_json.hpp"
#include "laser/draw_triangle.hpp"
#include "octurn/error.hpp"
#include "octurn/model.hpp"
#include "octurn/units.hpp"

namespace octurn {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

constexpr std::size_t max_pictures = 36;     // of a pose: 10 degrees apart
constexpr double min_picture_cosine = 0.25;  // of incidence, 75 degrees: beyond, pixels are smeared
constexpr double behind_surface = 0.002;     // metres: depth is drawn at the pixel's centre
constexpr double min_depth = 0.01;           // metres in front of the camera
constexpr float bright_level = 240;          // of the brightest colours after brightening
constexpr Rgb white = {255, 255, 255};

/// The weighted sum of a vertex's colours in the pictures.
struct Seen {
  Vector3f sum = Vector3f::Zero();
  float weight = 0;
};

/// Selects the shots whose pictures are read: evenly spaced over each pose.
std::vector<std::size_t> chosen_shots(const Scan& scan) {
  std::map<int, std::vector<std::size_t>> poses;
  for (std::size_t shot = 0; shot < scan.shots.size(); ++shot) {
    poses[scan.shots[shot].pose].push_back(shot);
  }
  std::vector<std::size_t> chosen;
  for (const auto& [pose, shots] : poses) {
    const std::size_t count = std::min(shots.size(), max_pictures);
    for (std::size_t i = 0; i < count; ++i) {
      chosen.push_back(shots[i * shots.size() / count]);
    }
  }
  return chosen;
}

/// The vertex normals, of length one, weighted by the triangles' areas; zero without triangles.
std::vector<Vector3f> vertex_normals(const VertexMesh& mesh) {
  std::vector<Vector3f> normals(mesh.vertices.size(), Vector3f::Zero());
  const auto at = [&](std::uint32_t vertex) {
    return Eigen::Map<const Vector3f>(mesh.vertices[vertex].data());
  };
  for (const auto& [a, b, c] : mesh.triangles) {
    const Vector3f normal = (at(b) - at(a)).cross(at(c) - at(a));
    for (const std::uint32_t vertex : {a, b, c}) {
      normals[vertex] += normal;
    }
  }
  std::ranges::for_each(normals, [](Vector3f& normal) { normal.normalize(); });
  return normals;
}

/// Renders the model's inverse depth with a camera without distortion, 1 / metres; 0 is background.
std::vector<float> draw(const VertexMesh& mesh, std::span<const Vector3d> in_camera,
                        const Intrinsics& lens) {
  std::vector<float> image(static_cast<std::size_t>(lens.width) *
                           static_cast<std::size_t>(lens.height));
  for (const auto& triangle : mesh.triangles) {
    std::array<ImageCorner, 3> corners{};
    bool is_before = true;
    for (std::size_t i = 0; i < 3; ++i) {
      const Vector3d& point = in_camera[triangle[i]];
      is_before = is_before && point.z() > min_depth;
      const Eigen::Vector2d pixel = project(lens, point);
      corners[i] = {.u = pixel.x(), .v = pixel.y(), .inverse_depth = 1 / point.z()};
    }
    if (!is_before) {
      continue;
    }
    visit_pixels(
        corners, lens.width, lens.height, [&](int u, int v, const std::array<double, 3>& shares) {
          float& nearest =
              image[static_cast<std::size_t>(v) * static_cast<std::size_t>(lens.width) +
                    static_cast<std::size_t>(u)];
          nearest = std::max(nearest, static_cast<float>(inverse_depth_at(corners, shares)));
        });
  }
  return image;
}

/// Interpolates a picture's colour (bilinear); nothing outside.
std::optional<Vector3f> colour_at(const ColourPicture& picture, const Eigen::Vector2d& pixel) {
  const double left = std::floor(pixel.x());
  const double top = std::floor(pixel.y());
  if (!(left >= 0 && top >= 0 && left + 1 < picture.width && top + 1 < picture.height)) {
    return std::nullopt;
  }
  const auto x = static_cast<float>(pixel.x() - left);
  const auto y = static_cast<float>(pixel.y() - top);
  const auto width = static_cast<std::size_t>(picture.width);
  const std::size_t first = static_cast<std::size_t>(top) * width + static_cast<std::size_t>(left);
  const auto colour = [&](std::size_t at) {
    const auto& [r, g, b] = picture.pixels[at];
    return Vector3f(r, g, b);
  };
  return Vector3f((1 - y) * ((1 - x) * colour(first) + x * colour(first + 1)) +
                  y * ((1 - x) * colour(first + width) + x * colour(first + width + 1)));
}

/// Adds the colours of the vertices that one picture sees.
void look(const VertexMesh& mesh, std::span<const Vector3f> normals, const ColourPicture& picture,
          const Scan& scan, const Eigen::Isometry3d& object_from_sensor, std::span<Seen> seen) {
  const Intrinsics& lens = scan.intrinsics;
  const RadialDistortion distortion{.k1 = scan.laser->k1, .k2 = scan.laser->k2};
  const Eigen::Isometry3d sensor_from_object = object_from_sensor.inverse();
  std::vector<Vector3d> in_camera;
  in_camera.reserve(mesh.vertices.size());
  for (const auto& [x, y, z] : mesh.vertices) {
    in_camera.push_back(sensor_from_object * Vector3d(metres_from_mm(static_cast<double>(x)),
                                                      metres_from_mm(static_cast<double>(y)),
                                                      metres_from_mm(static_cast<double>(z))));
  }
  const std::vector<float> nearest = draw(mesh, in_camera, lens);
  for (std::size_t i = 0; i < in_camera.size(); ++i) {
    const Vector3d& point = in_camera[i];
    const Vector3d normal = sensor_from_object.linear() * normals[i].cast<double>();
    const double cosine = -normal.dot(point) / point.norm();
    if (point.z() < min_depth || !(cosine > min_picture_cosine)) {
      continue;
    }
    const Eigen::Vector2d ideal = project(lens, point);
    const Eigen::Vector2d rounded = ideal.array().round();
    if (!(rounded.x() >= 0 && rounded.y() >= 0 && rounded.x() < lens.width &&
          rounded.y() < lens.height)) {
      continue;
    }
    const auto pixel =
        static_cast<std::size_t>(rounded.y()) * static_cast<std::size_t>(lens.width) +
        static_cast<std::size_t>(rounded.x());
    if (static_cast<double>(nearest[pixel]) > 1 / std::max(point.z() - behind_surface, min_depth)) {
      continue;  // occluded
    }
    const double distorting = distortion.distorting_factor((point.head<2>() / point.z()).norm());
    const Vector3d shown(distorting * point.x(), distorting * point.y(), point.z());
    if (const auto colour = colour_at(picture, project(lens, shown))) {
      const auto weight = static_cast<float>(cosine * cosine);
      seen[i].sum += weight * *colour;
      seen[i].weight += weight;
    }
  }
}

/// Gives vertices without a colour the mean of their neighbours, from the coloured ones outward.
void spread(const VertexMesh& mesh, std::span<Seen> seen) {
  for (bool has_changed = true; has_changed;) {
    has_changed = false;
    std::vector<Seen> around(seen.size());
    for (const auto& triangle : mesh.triangles) {
      for (std::size_t i = 0; i < 3; ++i) {
        const Seen& from = seen[triangle[i]];
        for (const std::size_t other : {(i + 1) % 3, (i + 2) % 3}) {
          if (from.weight > 0 && seen[triangle[other]].weight == 0) {
            around[triangle[other]].sum += from.sum / from.weight;
            around[triangle[other]].weight += 1;
          }
        }
      }
    }
    for (std::size_t i = 0; i < seen.size(); ++i) {
      if (around[i].weight > 0) {
        seen[i] = around[i];
        has_changed = true;
      }
    }
  }
}

ColourPicture read_dark_picture(const std::filesystem::path& folder, const Shot& shot,
                                const Intrinsics& lens) {
  const std::string& file = shot.pictures.front();
  const std::string png = read_scan_file(folder / file);
  return decode_rgb_png(file, std::as_bytes(std::span(png)), lens.width, lens.height);
}

/// The factor by which all colours are brightened: hues stay.
float brightening(std::span<const Seen> seen) {
  std::vector<float> levels;  // brightest channel of each seen vertex
  for (const Seen& vertex : seen) {
    if (vertex.weight > 0) {
      levels.push_back(vertex.sum.maxCoeff() / vertex.weight);
    }
  }
  if (levels.empty()) {
    return 1;
  }
  const auto bright = levels.begin() + static_cast<std::ptrdiff_t>(levels.size() * 99 / 100);
  std::ranges::nth_element(levels, bright);
  return std::max(1.0F, bright_level / std::max(*bright, 1.0F));
}

Rgb mean(const Seen& seen, float factor) {
  if (seen.weight == 0) {
    return white;
  }
  const auto channel = [&](Eigen::Index i) {
    const float level = factor * seen.sum[i] / seen.weight;
    return static_cast<std::uint8_t>(std::lround(std::min(level, 255.0F)));
  };
  return {channel(0), channel(1), channel(2)};
}

}  // namespace

std::vector<Rgb> vertex_colours(const std::filesystem::path& folder, const Scan& scan,
                                const VertexMesh& mesh, const std::stop_token& stop) {
  if (!scan.laser) {
    throw Error(ErrorCode::scan_malformed, "the scan has no pictures, and so no colours",
                "Only a scan by laser line has them.");
  }
  const std::vector<Vector3f> normals = vertex_normals(mesh);
  std::vector<Seen> seen(mesh.vertices.size());
  for (const std::size_t index : chosen_shots(scan)) {
    throw_if_stopped(stop);
    const Shot& shot = scan.shots[index];
    std::optional<ColourPicture> picture;
    try {
      picture = read_dark_picture(folder, shot, scan.intrinsics);
    } catch (const Error& error) {
      if (error.code() != ErrorCode::snapshot_malformed) {
        throw;
      }
    }
    if (picture) {
      look(mesh, normals, *picture, scan, model_pose(scan, shot), seen);
    }
  }
  spread(mesh, seen);
  std::vector<Rgb> colours(seen.size());
  std::ranges::transform(seen, colours.begin(), [factor = brightening(seen)](const Seen& vertex) {
    return mean(vertex, factor);
  });
  return colours;
}

}  // namespace octurn
