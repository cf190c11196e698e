#include "capture/wall_views.hpp"

#include <algorithm>
#include <charconv>
#include <chrono>
#include <cmath>
#include <exception>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "calibration/optics_files.hpp"
#include "calibration/sensor_map_files.hpp"
#include "log.hpp"
#include "octurn/png.hpp"
#include "octurn/units.hpp"
#include "sensor/new_folder.hpp"
#include "store/data_folder.hpp"
#include "wall_clock.hpp"

namespace octurn {
namespace {

namespace fs = std::filesystem;

constexpr double mean_unit = 5e-5;     // metres: 16 bits of it reach 3.2 m
constexpr double same_distance = 0.1;  // metres: closer walls show no change with distance
constexpr double first_wall = 0.65;    // metres, of a simulated sensor: where an object stands
constexpr double second_wall = 0.9;

struct StoredView {
  fs::path folder = {};
  double distance = 0;  // metres
};

/// Finds the stored wall views of a sensor, nearest first.
std::vector<StoredView> find_views(const fs::path& folder) {
  std::vector<StoredView> stored;
  for (const std::string& name : names_in(folder)) {
    int mm = 0;
    const char* const end = name.data() + name.size();
    const auto read = std::from_chars(name.data(), end, mm);
    if (read.ec == std::errc() && read.ptr == end) {
      stored.push_back({.folder = folder / name, .distance = metres_from_mm(mm)});
    }
  }
  std::ranges::sort(stored, {}, &StoredView::distance);
  return stored;
}

/// Returns the mean of a view's frames, in `mean_unit`.
DepthFrame to_mean_frame(const WallView& view) {
  const Intrinsics& lens = view.intrinsics();
  DepthFrame mean{.width = lens.width, .height = lens.height};
  for (int v = 0; v < lens.height; ++v) {
    for (int u = 0; u < lens.width; ++u) {
      const double inverse_depth = view.inverse_depth(u, v);
      const double units = inverse_depth > 0 ? 1 / (inverse_depth * mean_unit) : 0;
      mean.depth.push_back(units < 65535 ? static_cast<std::uint16_t>(std::lround(units))
                                         : std::uint16_t{0});
    }
  }
  return mean;
}

WallView to_view(const Intrinsics& lens, const DepthFrame& mean, std::optional<double> on_for) {
  WallView view(lens, on_for);
  view.add(mean);
  return view;
}

WallView read_stored_view(const fs::path& folder) {
  const Wall wall = read_wall(folder);
  return to_view(wall.intrinsics, read_wall_frame(folder, wall, 0), wall.sensor_on_for);
}

void keep_map(const fs::path& data, std::string_view serial, SensorMap& map) {
  map.serial = serial;
  map.made = utc_text(std::chrono::system_clock::now(), rfc3339);
  write_sensor_map(sensor_map_path(data, serial), map);
}

void keep_view(const fs::path& folder, std::string_view serial, const WallView& view,
               const DepthFrame& mean) {
  fs::remove_all(folder);
  NewFolder made(folder);
  const Wall wall{.sensor_name = "mean of a look",
                  .sensor_serial = std::string(serial),
                  .intrinsics = view.intrinsics(),
                  .sensor_on_for = view.on_for(),
                  .frames = {wall_frame_file(0)}};
  write_depth_png(made.path() / wall.frames.front(), mean);
  write_wall(made.path(), wall);
  made.commit();
}

}  // namespace

std::optional<WallView> look_at_wall(
    DepthSensor& sensor, int frames, double wall, std::optional<double> on_for,
    const std::stop_token& stop,
    const std::function<void(const DepthFrame& frame, int frames)>& on_frame) {
  sensor.show_wall(wall);
  const auto shown = std::chrono::steady_clock::now();
  WallView view(sensor.intrinsics(), on_for);
  while (view.frames() < frames) {
    const std::optional<TimedFrame> timed = sensor.read(stop);
    if (!timed) {
      break;
    }
    if (timed->time > shown) {
      view.add(timed->frame);
      on_frame(timed->frame, view.frames());
    }
  }
  sensor.show_wall(std::nullopt);
  return view.frames() < frames ? std::nullopt : std::optional(std::move(view));
}

double next_wall(const fs::path& data, std::string_view serial) {
  const std::vector<StoredView> stored = find_views(wall_views_path(data, serial));
  const bool has_first = std::ranges::any_of(stored, [](const StoredView& one) {
    return std::abs(one.distance - first_wall) < same_distance;
  });
  return has_first ? second_wall : first_wall;
}

void remake_sensor_map(const fs::path& data, std::string_view serial) try {
  std::vector<WallView> views;
  for (const StoredView& stored : find_views(wall_views_path(data, serial))) {
    views.push_back(read_stored_view(stored.folder));
  }
  if (views.empty()) {
    return;
  }
  SensorMapReport report = fit_sensor_map(views, optics_in_force(data, serial));
  if (report.accepted) {
    keep_map(data, serial, report.map);
  } else {
    log::warning("calibration", "the sensor's map is not made again: " + report.reason);
  }
} catch (const std::exception& error) {
  log::warning("calibration", std::string("the sensor's map is not made again: ") + error.what());
}

SensorMapReport add_wall(const fs::path& data, std::string_view serial, const WallView& view) {
  const DepthFrame mean = to_mean_frame(view);
  Intrinsics lens = view.intrinsics();
  lens.depth_unit = mean_unit;
  std::vector<WallView> views{to_view(lens, mean, view.on_for())};
  const std::optional<SensorOptics> optics = optics_in_force(data, serial);
  SensorMapReport report = fit_sensor_map(views, optics);
  if (!report.accepted) {
    return report;
  }
  const double distance = report.walls.front().distance;
  const fs::path folder = wall_views_path(data, serial);
  std::vector<fs::path> outdated;
  for (const StoredView& stored : find_views(folder)) {
    WallView other = read_stored_view(stored.folder);
    if (std::abs(stored.distance - distance) < same_distance || other.intrinsics() != lens) {
      outdated.push_back(stored.folder);
    } else {
      views.push_back(std::move(other));
    }
  }
  report = views.size() > 1 ? fit_sensor_map(views, optics) : std::move(report);
  if (report.accepted) {
    std::ranges::for_each(outdated, [](const fs::path& old) { fs::remove_all(old); });
    keep_view(folder / std::to_string(std::lround(mm_from_metres(distance))), serial, views.front(),
              mean);
    keep_map(data, serial, report.map);
  }
  report.map.near = {};
  report.map.far = {};
  return report;
}

}  // namespace octurn
