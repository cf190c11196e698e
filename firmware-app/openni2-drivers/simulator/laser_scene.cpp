#include "simulator/laser_scene.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include "simulator/camera.hpp"
#include "simulator/noise_field.hpp"
#include "simulator/surroundings.hpp"

namespace octurn {
namespace {

/// Intrinsics of a virtual camera at the laser's source, with one column in the laser's plane. Its
/// rows are rays of the fan, 0.2 mm apart at 0.35 m. Its fx only has to keep triangles larger than
/// the ones that `rasterise` drops as degenerate.
constexpr Intrinsics fan_column{
    .width = 1, .height = 4096, .fx = 1700, .fy = 1700, .cx = 0, .cy = 2047.5};

// 1/m, 0.3 mm at 0.35 m: surfaces must not shadow themselves.
constexpr double shadow_slack = 0.0025;

}  // namespace

LaserFan::LaserFan(const Laser& laser, const Eigen::Vector3d& target)
    : shadow_map_(static_cast<std::size_t>(fan_column.height), 0.0F) {
  const Eigen::Vector3d& source = *laser.source;
  const Eigen::Vector3d way = target - source;
  Eigen::Matrix3d axes;  // of the fan, as columns
  axes.col(0) = laser.normal;
  axes.col(2) = (way - laser.normal * laser.normal.dot(way)).normalized();
  axes.col(1) = axes.col(2).cross(axes.col(0));
  fan_from_sensor_.linear() = axes.transpose();
  fan_from_sensor_.translation() = -(axes.transpose() * source);
  fan_from_sensor_.makeAffine();
}

void LaserFan::add(const Mesh& mesh, const Eigen::Isometry3d& sensor_from_mesh) {
  rasterise(mesh, fan_from_sensor_ * sensor_from_mesh, fan_column, shadow_map_);
}

bool LaserFan::reaches(const Eigen::Vector3d& point) const {
  const Eigen::Vector3d seen = fan_from_sensor_ * point;
  const double row = fan_column.fy * seen.y() / seen.z() + fan_column.cy;
  if (!(seen.z() > 0) || !(row >= 0) || !(row < fan_column.height - 1)) {
    return false;
  }
  const auto above = static_cast<std::size_t>(row);
  return 1 / seen.z() + shadow_slack >=
         static_cast<double>(std::min(shadow_map_[above], shadow_map_[above + 1]));
}

namespace {

// Grey levels.
constexpr float read_noise = 0.4F;
constexpr float shot_noise = 0.03F;  // variance for each level of light
constexpr float black_level = 1;     // subtracted by the camera
constexpr double room_light = 4;     // of a white surface that faces the camera
constexpr double line = 210;         // peak of a laser's line on a white surface, head on

constexpr double line_half_width = 0.0004;  // of a line, metres, to 1/e^2
constexpr double farthest = 2.6;            // half widths at which the line's profile is cut off
constexpr double bright_at = 0.33;          // metres from the laser at which the peak is `line`
// Variance of a pixel's area and of the lens's blur, square pixels.
constexpr double blur = 1.0 / 12 + 0.6 * 0.6;
constexpr float speckle = 0.25F;  // contrast
constexpr float flicker = 0.02F;

constexpr double check_side = 0.008;  // side of the object's checks, metres
constexpr double light_check = 0.95;
constexpr double dark_check = 0.61;
constexpr double surroundings_albedo = 0.35;
constexpr double saturation = 0.4;

double check_albedo(const Eigen::Vector3d& point) {
  const Eigen::Vector3d cells = (point / check_side).array().floor();
  const auto sum = static_cast<long>(cells.sum());
  return sum % 2 == 0 ? light_check : dark_check;
}

std::uint8_t to_grey(float light) {
  return static_cast<std::uint8_t>(std::clamp(std::lround(light), 0L, 255L));
}

/// The tint of the object's paint: its hue makes one turn about the axis, its luminance is white's.
Eigen::Vector2f axial_tint(const Eigen::Vector3d& point) {
  const Eigen::Vector2d outwards = point.head<2>();
  return (saturation * outwards / std::max(outwards.norm(), 1e-6)).cast<float>();
}

/// Converts luminance and tint to red, green and blue (ITU-R BT.601).
Rgb to_colour(float light, const Eigen::Vector2f& tint) {
  return {to_grey(light * (1 + 1.402F * tint.y())),
          to_grey(light * (1 - 0.344136F * tint.x() - 0.714136F * tint.y())),
          to_grey(light * (1 + 1.772F * tint.x()))};
}

}  // namespace

LaserScene::LaserScene(const LaserSimulation& simulation)
    : simulation_(simulation),
      object_(told_object(simulation.mesh_file)),
      noise_(simulation.seed),
      background_(pixels(simulation.lens), 0.0F) {
  const Eigen::Isometry3d sensor_from_platform = simulation_.platform_from_sensor.inverse();
  const Mesh around = surroundings();
  rasterise(around, sensor_from_platform, simulation_.lens, background_);
  for (const Laser& laser : simulation_.lasers) {
    LaserFan fan(laser, sensor_from_platform * Eigen::Vector3d::Zero());
    fan.add(around, sensor_from_platform);
    fans_at_rest_.push_back(std::move(fan));
  }
}

void LaserScene::set_object_pose(int pose) {
  if (object_.set_pose(pose)) {
    seen_.clear();
  }
}

/// Renders what camera and lasers see at an angle of the platform.
void LaserScene::render(double angle) {
  angle_ = angle;
  const Eigen::Isometry3d sensor_from_object =
      simulation_.platform_from_sensor.inverse() * object_.platform_from_mesh(angle);
  object_from_sensor_ = sensor_from_object.inverse();
  seen_ = background_;
  rasterise(object_.mesh(), sensor_from_object, simulation_.lens, seen_);
  fans_ = fans_at_rest_;
  for (LaserFan& fan : fans_) {
    fan.add(object_.mesh(), sensor_from_object);
  }
  const int width = simulation_.lens.width;
  room_light_.assign(seen_.size(), 0);
  tints_.assign(seen_.size(), Eigen::Vector2f::Zero());
  for (std::size_t pixel = 0; pixel < seen_.size(); ++pixel) {
    const auto at = static_cast<int>(pixel);
    if (const Patch seen = patch(at % width, at / width); seen.is_seen) {
      const double facing = -seen.normal.dot(seen.point.normalized());
      room_light_[pixel] = static_cast<float>(room_light * seen.albedo * (0.65 + 0.35 * facing));
      tints_[pixel] = seen.tint;
    }
  }
}

/// The slope of inverse depth, 1/m for each pixel: the smaller one-sided difference, as the other
/// may cross an edge.
/// @param step  index offset of the next pixel
double LaserScene::slope(std::size_t pixel, std::ptrdiff_t step, bool is_first,
                         bool is_last) const {
  const float* const here = seen_.data() + pixel;
  const float before = is_first ? here[step] - here[0] : here[0] - here[-step];
  const float after = is_last ? before : here[step] - here[0];
  return static_cast<double>(std::abs(before) < std::abs(after) ? before : after);
}

LaserScene::Patch LaserScene::patch(int u, int v) const {
  const Intrinsics& lens = simulation_.lens;
  const std::size_t pixel = static_cast<std::size_t>(v) * static_cast<std::size_t>(lens.width) +
                            static_cast<std::size_t>(u);
  if (seen_[pixel] <= 0) {
    return {};
  }
  const auto inverse = static_cast<double>(seen_[pixel]);
  const Eigen::Vector3d ray((u - lens.cx) / lens.fx, (v - lens.cy) / lens.fy, 1);
  // On a plane 1 / z = a u + b v + c; times z that is n . p = 1.
  const double a = slope(pixel, 1, u == 0, u == lens.width - 1);
  const double b = slope(pixel, lens.width, v == 0, v == lens.height - 1);
  const Eigen::Vector3d normal(a * lens.fx, b * lens.fy,
                               inverse + a * (lens.cx - u) + b * (lens.cy - v));
  Patch seen{.point = ray / inverse, .normal = -normal.normalized(), .is_seen = true};
  seen.albedo = surroundings_albedo;
  if (seen_[pixel] > background_[pixel]) {
    const Eigen::Vector3d on_object = object_from_sensor_ * seen.point;
    seen.albedo = check_albedo(on_object);
    seen.tint = axial_tint(on_object);
  }
  return seen;
}

/// Grey levels of a laser's line at a pixel, without speckle.
double LaserScene::line_light(std::size_t laser, const Patch& patch) const {
  const Laser& of = simulation_.lasers[laser];
  const double off = of.normal.dot(patch.point) - of.distance;
  const Eigen::Vector3d to_source = *of.source - patch.point;
  const double distance = to_source.norm();
  const double lambert = patch.normal.dot(to_source) / distance;
  if (lambert <= 0) {
    return 0;
  }
  // The length across the laser's plane of a step of one pixel on the surface. Blur of the pixel
  // widens the line's Gaussian by it.
  const Intrinsics& lens = simulation_.lens;
  const Eigen::Vector3d ray = patch.point / patch.point.z();
  const auto step = [&](const Eigen::Vector3d& aside) {
    const Eigen::Vector3d way = aside - ray * (patch.normal.dot(aside) / patch.normal.dot(ray));
    return of.normal.dot(way) * patch.point.z();
  };
  const double across = std::hypot(step(Eigen::Vector3d::UnitX() / lens.fx),
                                   step(Eigen::Vector3d::UnitY() / lens.fy));
  const double variance = line_half_width * line_half_width / 4;
  const double blurred = variance + blur * across * across;
  if (off * off > farthest * farthest * 4 * blurred || !fans_[laser].reaches(patch.point)) {
    return 0;
  }
  return line * lambert * patch.albedo * (bright_at / distance) * std::sqrt(variance / blurred) *
         std::exp(-off * off / (2 * blurred));
}

void LaserScene::add_line(std::size_t laser, std::vector<float>& light) const {
  const Intrinsics& lens = simulation_.lens;
  const Laser& of = simulation_.lasers[laser];
  // Speckle is fixed to the surface: it does not change while the platform stands.
  const std::uint32_t place =
      mixed(static_cast<std::uint32_t>(std::bit_cast<std::uint64_t>(angle_) >> 20U),
            static_cast<std::uint32_t>(laser));
  // In metres: twice the cut-off, to include blur.
  const double reach = farthest * 2 * line_half_width;
  std::size_t pixel = 0;
  for (int v = 0; v < lens.height; ++v) {
    const std::uint32_t sequence = mixed(place, static_cast<std::uint32_t>(v));
    for (int u = 0; u < lens.width; ++u, ++pixel) {
      const auto inverse = static_cast<double>(seen_[pixel]);
      const double along = of.normal.x() * (u - lens.cx) / lens.fx +
                           of.normal.y() * (v - lens.cy) / lens.fy + of.normal.z();
      if (!(std::abs(along - of.distance * inverse) < reach * inverse)) {
        continue;
      }
      if (const double lit = line_light(laser, patch(u, v)); lit > 0) {
        const auto at = static_cast<std::size_t>(u);
        const float grain = (noise_.at(sequence, at) + 2 * noise_.at(sequence, at + 1) +
                             noise_.at(sequence, at + 2)) /
                            std::sqrt(6.0F);
        light[pixel] += static_cast<float>(lit) * std::max(0.0F, 1 + speckle * grain);
      }
    }
  }
}

/// The light at the camera's pixels with noise, grey levels before rounding.
std::vector<float> LaserScene::levels(double angle, std::optional<std::size_t> lit) {
  if (seen_.empty() || angle != angle_) {
    render(angle);
  }
  const Intrinsics& lens = simulation_.lens;
  const std::uint32_t number = mixed(simulation_.seed + 1, ++pictures_);
  const float lamp = 1 + flicker * noise_.at(number, 0);
  std::vector<float> light(room_light_);
  for (float& level : light) {
    level *= lamp;
  }
  if (lit) {
    add_line(*lit, light);
  }
  std::size_t pixel = 0;
  for (int v = 0; v < lens.height; ++v) {
    const std::uint32_t sequence = mixed(number, static_cast<std::uint32_t>(v));
    for (std::size_t u = 0; u < static_cast<std::size_t>(lens.width); ++u, ++pixel) {
      const float spread = std::sqrt(read_noise * read_noise + shot_noise * light[pixel]);
      light[pixel] = light[pixel] + spread * noise_.at(sequence, u) - black_level + 0.4F;
    }
  }
  return light;
}

Picture LaserScene::to_picture(const std::vector<float>& levels) const {
  Picture picture{.width = simulation_.lens.width, .height = simulation_.lens.height};
  picture.samples.resize(levels.size());
  std::ranges::transform(levels, picture.samples.begin(), to_grey);
  return picture;
}

Picture LaserScene::expose(double angle, std::optional<std::size_t> lit) {
  return to_picture(levels(angle, lit));
}

ColourExposure LaserScene::expose_in_colour(double angle, std::optional<std::size_t> lit) {
  const std::vector<float> light = levels(angle, lit);
  ColourExposure seen{.picture = to_picture(light)};
  seen.colours.resize(light.size());
  std::ranges::transform(light, tints_, seen.colours.begin(), to_colour);
  return seen;
}

}  // namespace octurn
