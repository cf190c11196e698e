#include "scan/scan_settings.hpp"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <nlohmann/json.hpp>
#include <thread>

#include "octurn/json_object.hpp"
#include "octurn/platform_pose.hpp"
#include "octurn/units.hpp"

namespace octurn {
namespace {

using nlohmann::json;

constexpr int most_snapshots = 200;    // the full steps of a turn of the coarsest stepper
constexpr int most_frames = 100;       // 3 s at 30 frames a second: more does not lower the noise
constexpr double farthest_mm = 10000;  // no depth sensor of this kind sees farther
constexpr double largest_root_mm = 5000;
constexpr double most_error_mm = 10;
constexpr double finest_leaf_mm =
    0.1;  // the octree has 16 levels, which at the largest root is 0.08

/// Millimetres to the nanometre, so that 0.14 m is 140 and not 140.00000000000003.
double whole_mm(double metres) { return std::round(mm_from_metres(metres) * 1e6) / 1e6; }

Eigen::Vector3d metres(const json& mm, std::size_t first) {
  return {metres_from_mm(mm[first].get<double>()), metres_from_mm(mm[first + 1].get<double>()),
          metres_from_mm(mm[first + 2].get<double>())};
}

bool all_numbers(const json& array, std::size_t size, double most) {
  return array.is_array() && array.size() == size &&
         std::ranges::all_of(array, [&](const json& value) {
           return value.is_number() && std::abs(value.get<double>()) <= most;
         });
}

Box clip_from(const JsonObject& settings, const json& mm) {
  const std::string must =
      "six numbers, x0 y0 z0 x1 y1 z1, from -10000 to 10000, each of the first three below its "
      "partner";
  if (!all_numbers(mm, 6, farthest_mm)) {
    settings.refuse("clip_mm", mm, must);
  }
  Box clip{.min = metres(mm, 0), .max = metres(mm, 3)};
  if ((clip.min.array() >= clip.max.array()).any()) {
    settings.refuse("clip_mm", mm, must);
  }
  return clip;
}

Eigen::Isometry3d pose_from(const JsonObject& settings, const json& rows) {
  const std::string must =
      "four rows of four numbers, a rotation and a translation in metres, the last row 0 0 0 1";
  Eigen::Matrix4d pose = Eigen::Matrix4d::Zero();
  for (int row = 0; row < 4; ++row) {
    if (!rows.is_array() || rows.size() != 4 ||
        !all_numbers(rows[static_cast<std::size_t>(row)], 4, metres_from_mm(farthest_mm))) {
      settings.refuse("platform_from_sensor", rows, must);
    }
    for (int column = 0; column < 4; ++column) {
      pose(row, column) =
          rows[static_cast<std::size_t>(row)][static_cast<std::size_t>(column)].get<double>();
    }
  }
  if (!is_rigid(pose)) {
    settings.refuse("platform_from_sensor", rows, must);
  }
  return Eigen::Isometry3d(pose);
}

}  // namespace

int available_threads() {
  return std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
}

std::size_t half_of_memory() {
  return static_cast<std::size_t>(::sysconf(_SC_PHYS_PAGES)) / 2 *
         static_cast<std::size_t>(::sysconf(_SC_PAGESIZE));
}

ReconstructOptions reconstruct_options(const ScanSettings& settings, const Limits& limits) {
  return {.method = settings.method,
          .leaf_size = settings.leaf_size,
          .root_size = settings.root_size,
          .threshold = settings.threshold,
          .clip = settings.clip,
          .target_error = settings.target_error,
          .threads = limits.threads,
          .memory_limit = limits.memory_bytes};
}

json json_of(const ScanSettings& settings) {
  json rows = json::array();
  for (int row = 0; row < 4; ++row) {
    const Eigen::Matrix4d& pose = settings.platform_from_sensor.matrix();
    rows.push_back({pose(row, 0), pose(row, 1), pose(row, 2), pose(row, 3)});
  }
  json clip = json::array();
  for (const Eigen::Vector3d& corner : {settings.clip.min, settings.clip.max}) {
    for (const double metres : corner) {
      clip.push_back(whole_mm(metres));
    }
  }
  return {{"snapshots", settings.snapshots},
          {"filter", name_of(settings.filter)},
          {"frames", settings.frames},
          {"method", name_of(settings.method)},
          {"leaf_size_mm", whole_mm(settings.leaf_size)},
          {"max_error_mm", whole_mm(settings.target_error)},
          {"threshold_m2", settings.threshold},
          {"root_size_mm", whole_mm(settings.root_size)},
          {"clip_mm", clip},
          {"platform_from_sensor", rows}};
}

ScanSettings settings_from(const json& object, const ScanSettings& defaults,
                           const std::string& name) {
  JsonObject keys(object, "bad-settings", name);
  ScanSettings settings = defaults;
  settings.snapshots =
      keys.whole_number("snapshots", 1, most_snapshots).value_or(defaults.snapshots);
  settings.frames = keys.whole_number("frames", 1, most_frames).value_or(defaults.frames);
  settings.threshold = keys.number("threshold_m2", 1e-8, 1).value_or(defaults.threshold);
  if (const json* filter = keys.find("filter")) {
    const auto named =
        filter->is_string() ? depth_filter_named(filter->get<std::string>()) : std::nullopt;
    if (!named) {
      keys.refuse("filter", *filter, "\"basic\", \"average\" or \"average-discard\"");
    }
    settings.filter = *named;
  }
  if (const json* method = keys.find("method")) {
    const auto named =
        method->is_string() ? method_named(method->get<std::string>()) : std::nullopt;
    if (!named) {
      keys.refuse("method", *method, "\"solid\" or \"intersection\"");
    }
    settings.method = *named;
  }
  if (const auto mm = keys.number("max_error_mm", 0, most_error_mm)) {
    settings.target_error = metres_from_mm(*mm);
  }
  if (const auto mm = keys.number("root_size_mm", 10, largest_root_mm)) {
    settings.root_size = metres_from_mm(*mm);
  }
  if (const auto mm = keys.number("leaf_size_mm", finest_leaf_mm, largest_root_mm)) {
    settings.leaf_size = metres_from_mm(*mm);
  }
  if (settings.leaf_size > settings.root_size) {
    keys.refuse("leaf_size_mm", whole_mm(settings.leaf_size), "at most root_size_mm");
  }
  if (const json* mm = keys.find("clip_mm")) {
    settings.clip = clip_from(keys, *mm);
  }
  if (const json* rows = keys.find("platform_from_sensor")) {
    settings.platform_from_sensor = pose_from(keys, *rows);
  }
  keys.refuse_unread();
  return settings;
}

}  // namespace octurn
