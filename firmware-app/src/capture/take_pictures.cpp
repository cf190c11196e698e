#include "capture/take_pictures.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "octurn/error.hpp"
#include "rig/interruptible_sleep.hpp"
#include "store/stored_scan.hpp"

namespace octurn {
namespace {

using Clock = std::chrono::steady_clock;

// Pictures begun before a laser was switched that a camera may still hand out: a second of them, at
// 30 Hz.
constexpr int max_stale_pictures = 30;

// Too bright to see a line: a quarter of the pixels is near saturation.
constexpr std::uint8_t white = 240;
constexpr double max_white_share = 0.25;

// A line: in one of 30 rows a pixel is brighter by as much as a line must be to be found, and by
// twice as much as any pixel of the row is darker. A laser only adds light, while noise takes as
// much as it adds.
constexpr int min_line_levels = 8;
constexpr int noises_of_line = 2;
constexpr int rows_per_line_row = 30;

// The stamp of a USB camera's picture is the host's, when the picture has arrived: it may have been
// exposed some pictures before. More than this, and a scan would take minutes longer.
constexpr int max_late = 4;
constexpr int switchings = 5;  // of a laser, of which the latest picture counts
// Waited before each switching, times its number: lasers are switched at several moments of an
// exposure.
constexpr std::chrono::milliseconds later_each_time{9};
constexpr double whole_light = 0.8;  // of a laser's: a smaller share was exposed in part
constexpr double no_light = 0.1;

/// `Camera::read`, or the same with colours.
using Read = std::optional<TimedPicture> (Camera::*)(const std::stop_token& stop);

/// Takes a picture whose exposure began after `switched` by its stamp; nothing if stopped first.
std::optional<TimedPicture> read_picture(Camera& camera, Read read, Clock::time_point switched,
                                         const std::stop_token& stop,
                                         const ScanObserver& observer) {
  for (int stale = 0; stale <= max_stale_pictures; ++stale) {
    std::optional<TimedPicture> timed = (camera.*read)(stop);
    if (!timed || timed->begin >= switched) {
      if (timed) {
        observer.on_picture(timed->picture);
      }
      return timed;
    }
  }
  throw Error(ErrorCode::sensor_failed,
              camera.name() +
                  ": its pictures arrive too late; they are from before the platform stopped or a "
                  "laser was switched",
              "Unplug the camera, and plug it in again.");
}

void expect_size_for_scan(const Picture& picture, const Intrinsics& lens,
                          const std::string& camera) {
  if (picture.width != lens.width || picture.height != lens.height) {
    throw Error(ErrorCode::sensor_other,
                camera + ": its pictures have " + std::to_string(picture.width) + " x " +
                    std::to_string(picture.height) + " pixels, where the settings say " +
                    std::to_string(lens.width) + " x " + std::to_string(lens.height),
                "Plug in the camera that the settings are of, or correct laser.width and the "
                "other keys of its lens.",
                {{"camera", camera},
                 {"width_px", static_cast<double>(picture.width)},
                 {"height_px", static_cast<double>(picture.height)},
                 {"told_width_px", static_cast<double>(lens.width)},
                 {"told_height_px", static_cast<double>(lens.height)}});
  }
}

/// The light of a line in a row of a picture, grey levels; 0 if it shows none that is not in the
/// dark picture.
/// @param changes  of the row's pixels, grey levels; reordered
int light_in(std::span<int> changes) {
  const auto middle = changes.begin() + static_cast<std::ptrdiff_t>(changes.size() / 2);
  std::ranges::nth_element(changes, middle);
  const int room = *middle;  // a lamp's flicker
  const auto [darkest, brightest] = std::ranges::minmax(changes);
  const bool is_line =
      brightest - room >= std::max(min_line_levels, noises_of_line * (room - darkest));
  return is_line ? brightest - room : 0;
}

/// A laser's line in a picture.
struct SeenLine {
  int rows = 0;      // that show it
  double light = 0;  // grey levels, the sum of the rows'; 0: too few rows show it
};

SeenLine find_light(const Picture& dark, const Picture& lit) {
  const auto width = static_cast<std::size_t>(lit.width);
  std::vector<int> changes(width);
  SeenLine line;
  for (std::size_t first = 0; first < lit.samples.size(); first += width) {
    for (std::size_t u = 0; u < width; ++u) {
      changes[u] =
          static_cast<int>(lit.samples[first + u]) - static_cast<int>(dark.samples[first + u]);
    }
    const int light = light_in(changes);
    line.rows += light > 0 ? 1 : 0;
    line.light += light;
  }
  if (line.rows * rows_per_line_row < lit.height) {
    line.light = 0;
  }
  return line;
}

/// Measures how late the pictures of a camera are that was opened: by how many pictures a laser
/// shows, or still shows, after it was switched.
class LatenessMeter {
 public:
  /// @param dark  of the platform that stands, with all lasers off
  LatenessMeter(Rig& rig, const Picture& dark, const std::stop_token& stop,
                const ScanObserver& observer)
      : rig_(rig), dark_(dark), stop_(stop), observer_(observer) {}

  /// @return pictures, 0 if no laser shows; nothing if stopped first
  /// @throws Error "sensor-failed"  if they are more than `max_late` late
  std::optional<int> measure() {
    std::size_t laser = 0;  // the first one that shows
    for (; laser < rig_.lasers().count() && light_ == 0; ++laser) {
      if (!switch_laser(laser)) {
        return std::nullopt;
      }
    }
    for (int time = 1; light_ > 0 && time < switchings; ++time) {
      if (!sleep_for(stop_, time * later_each_time) || !switch_laser(laser - 1)) {
        return std::nullopt;
      }
    }
    return late_;
  }

 private:
  static constexpr int most = max_late + 3;  // pictures after a laser was switched

  /// Switches a laser on and off. @return false if stopped first
  bool switch_laser(std::size_t laser) {
    light_ = 0;
    {
      const Lasers::Light light = rig_.lasers().light(laser);
      if (!wait_for_light()) {
        return false;
      }
    }
    return wait_for_dark();
  }

  bool wait_for_light() {
    const Clock::time_point switched = rig_.camera().now();
    double before = 0;
    for (int picture = 0; picture < most && light_ == 0; ++picture) {
      const std::optional<double> light = read_light(switched);
      if (!light) {
        return false;
      }
      if (*light > 0 && before >= whole_light * *light) {
        light_ = *light;
        expect_in_time(picture - 1);
      }
      before = *light;
    }
    return true;
  }

  bool wait_for_dark() {
    const Clock::time_point switched = rig_.camera().now();
    for (int picture = 0; picture < most; ++picture) {
      const std::optional<double> light = read_light(switched);
      if (!light) {
        return false;
      }
      if (light_ > 0 && *light <= no_light * light_) {
        expect_in_time(picture);
        return true;
      }
      if (light_ == 0 && *light > 0) {
        expect_in_time(most);  // it did not show while it was on
      }
    }
    expect_in_time(light_ > 0 ? most : 0);
    return true;
  }

  /// Reads a picture. @return a laser's light in it; nothing if stopped first
  std::optional<double> read_light(Clock::time_point switched) {
    const auto timed = read_picture(rig_.camera(), &Camera::read, switched, stop_, observer_);
    if (!timed) {
      return std::nullopt;
    }
    expect_size_for_scan(timed->picture, rig_.laser()->lens, rig_.camera().name());
    return find_light(dark_, timed->picture).light;
  }

  void expect_in_time(int late) {
    if (late > max_late) {
      throw Error(ErrorCode::sensor_failed,
                  "the camera's pictures are more than " + std::to_string(max_late) +
                      " late: a laser that is switched on shows in a later one",
                  "Use another camera, or another USB port without other devices.",
                  {{"camera", rig_.camera().name()}});
    }
    late_ = std::max(late_, late);
  }

  Rig& rig_;
  const Picture& dark_;
  const std::stop_token& stop_;
  const ScanObserver& observer_;
  double light_ = 0;  // of the laser that was switched last; 0: it does not show
  int late_ = 0;      // pictures
};

}  // namespace

void expect_dark_room(const Picture& dark, const std::string& camera) {
  const auto bright =
      std::ranges::count_if(dark.samples, [](std::uint8_t level) { return level >= white; });
  const double share = static_cast<double>(bright) / static_cast<double>(dark.samples.size());
  if (share > max_white_share) {
    throw Error(ErrorCode::sensor_blind,
                camera + ": " + std::to_string(std::lround(100 * share)) +
                    " % of its picture without a laser is white: no line can be seen on that",
                "Darken the room, keep sunlight and lamps off the object, or expose for less long.",
                {{"white_share", share}});
  }
}

void expect_line(const Picture& dark, const Picture& lit, const std::string& laser) {
  const auto [rows, light] = find_light(dark, lit);
  if (light == 0) {
    throw Error(ErrorCode::sensor_blind,
                "laser " + laser + ": its picture shows no line, in " + std::to_string(rows) +
                    " of " + std::to_string(lit.height) + " rows there is more light",
                "Look at the laser without looking into it: its plug, its wires, what stands "
                "before it, and whether it is the one that its line is set for.",
                {{"laser", laser}});
  }
}

std::optional<StopPictures> take_pictures_here(Rig& rig, const std::stop_token& stop,
                                               const ScanObserver& observer,
                                               const KeepPicture& keep) {
  Camera& camera = rig.camera();
  Lasers& lasers = rig.lasers();
  StopPictures taken;
  std::vector<Picture>& pictures = taken.pictures;
  const auto take = [&](Read read) {
    const Clock::time_point switched = camera.now();
    std::optional<TimedPicture> timed;
    for (int late = lasers.late_pictures.value_or(max_late); late >= 0; --late) {
      timed = read_picture(camera, read, switched, stop, observer);
      if (!timed) {
        return timed;
      }
    }
    expect_size_for_scan(timed->picture, rig.laser()->lens, camera.name());
    pictures.push_back(std::move(timed->picture));
    return timed;
  };
  auto dark = take(&Camera::read_in_colour);
  if (!dark) {
    return std::nullopt;
  }
  taken.colours = std::move(dark->colours);
  expect_dark_room(pictures.front(), camera.name());
  if (!lasers.late_pictures) {
    lasers.late_pictures = LatenessMeter(rig, pictures.front(), stop, observer).measure();
    if (!lasers.late_pictures) {
      return std::nullopt;
    }
  }
  keep(pictures.front(), taken.colours);
  const std::vector<LaserLine> lines = lines_of(*rig.laser());
  for (std::size_t laser = 0; laser < lasers.count(); ++laser) {
    {
      const Lasers::Light light = lasers.light(laser);
      if (!take(&Camera::read)) {
        return std::nullopt;
      }
    }
    expect_line(pictures.front(), pictures.back(), lines[laser].laser.name);
    keep(pictures.back(), {});
  }
  return taken;
}

std::optional<StopPictures> take_pictures(Rig& rig, const Stop& at, const std::stop_token& stop,
                                          const ScanObserver& observer, const KeepPicture& keep) {
  rig.turntable();  // whose faults come before the camera's
  rig.camera();
  if (!turn_to(rig, at, stop, observer)) {
    return std::nullopt;
  }
  rig.show_platform();
  return take_pictures_here(rig, stop, observer, keep);
}

bool take_stop(Rig& rig, const Stop& at, double angle, const std::filesystem::path& folder,
               Scan& scan, const std::stop_token& stop, const ScanObserver& observer) {
  PictureWriter writer(folder, picture_files(static_cast<int>(scan.shots.size()), *scan.laser));
  const auto write = [&](const Picture& picture, const std::vector<Rgb>& colours) {
    writer.add(picture, colours);
  };
  if (!take_pictures(rig, at, stop, observer, write)) {
    return false;
  }
  writer.finish();
  store_stop(folder, scan, angle);
  return true;
}

PictureWriter::PictureWriter(std::filesystem::path folder, std::vector<std::string> files)
    : folder_(std::move(folder)), files_(std::move(files)) {}

void PictureWriter::add(Picture picture, std::vector<Rgb> colours) {
  finish();
  writing_ = std::async(std::launch::async,
                        [file = folder_ / files_.at(added_++), picture = std::move(picture),
                         colours = std::move(colours)] { write_picture(file, picture, colours); });
}

void PictureWriter::finish() {
  if (writing_.valid()) {
    writing_.get();
  }
}

}  // namespace octurn
