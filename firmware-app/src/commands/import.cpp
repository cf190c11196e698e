#include <algorithm>
#include <filesystem>
#include <iostream>
#include <span>
#include <sstream>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "commands/model_commands.hpp"
#include "commands/model_report.hpp"
#include "octurn/error.hpp"
#include "octurn/file.hpp"
#include "octurn/png.hpp"
#include "octurn/scan_folder.hpp"
#include "octurn/tiles.hpp"
#include "progress_bar.hpp"
#include "sensor/new_folder.hpp"
#include "signal_stop.hpp"
#include "store/tum_recording.hpp"

namespace octurn {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t max_image_bytes = std::size_t{64} << 20U;
constexpr int max_side = 8192;  // pixels, the limit of a scan's depth images

std::string read_image(const fs::path& file) {
  auto bytes = read_regular_file(file, max_image_bytes);
  if (!bytes) {
    throw Error(ErrorCode::scan_missing, file.string() + ": there is no such depth image",
                "depth.txt names it: the recording is not whole.");
  }
  return *std::move(bytes);
}

/// Sets the intrinsics' size to that of a PNG, whose header has it at a fixed place.
void take_size(const std::string& png, Intrinsics& intrinsics) {
  constexpr std::size_t width_at = 16;
  constexpr std::size_t header = 24;
  if (png.size() < header) {
    return;  // decoding refuses the image
  }
  const auto number = [&](std::size_t at) {
    int value = 0;
    for (std::size_t i = at; i < at + 4; ++i) {
      value = value << 8 | static_cast<unsigned char>(png[i]);
    }
    return value;
  };
  const int width = number(width_at);
  const int height = number(width_at + 4);
  if (width > 0 && width <= max_side && height > 0 && height <= max_side) {
    intrinsics.width = width;
    intrinsics.height = height;
  }
}

/// Copies the recording's depth images into the folder as snapshots. @return their scan
Scan gather(TumRecording recording, const ImportArguments& arguments, const fs::path& folder,
            const std::stop_token& stop) {
  const std::string camera =
      arguments.camera.empty() ? std::string(to_tum_camera(arguments.folder)) : arguments.camera;
  Scan scan{
      .sensor_name = "TUM RGB-D, " + camera, .intrinsics = tum_camera(camera), .clip = everywhere};
  if (scan.intrinsics.fy < 0) {
    scan.intrinsics.fy = -scan.intrinsics.fy;
    for (TumRecording::Image& image : recording.images) {
      image.world_from_camera = with_y_down(image.world_from_camera);
    }
  }
  scan.intrinsics.depth_unit = arguments.depth_unit.value_or(scan.intrinsics.depth_unit);
  fs::create_directories(folder / "snapshots");
  ProgressBar bar;
  for (const TumRecording::Image& image : recording.images) {
    throw_if_stopped(stop);
    const auto index = static_cast<int>(scan.shots.size());
    bar.show(index, static_cast<int>(recording.images.size()), "depth images");
    const std::string png = read_image(arguments.folder / image.file);
    if (index == 0) {
      take_size(png, scan.intrinsics);
    }
    // Decoded to refuse a damaged image now: the recording may be gone when a model is made.
    decode_depth_png(image.file, std::as_bytes(std::span(png)), scan.intrinsics.width,
                     scan.intrinsics.height);
    const std::string file = shot_file(index);
    fs::copy_file(arguments.folder / image.file, folder / file);
    scan.shots.push_back({.file = file, .object_from_sensor = image.world_from_camera});
  }
  return scan;
}

/// How a recording may be written: programs differ, and no file says.
struct Convention {
  double depth_unit = 0;          // metres
  bool is_inverted = false;       // the poses are camera_from_world
  bool is_back_to_front = false;  // the camera's Y points up and its Z back, as in OpenGL
  bool is_mirrored = false;       // Y has the other sign, in the camera and in the world
};

Eigen::Isometry3d pose_by(const Convention& convention, Eigen::Isometry3d pose) {
  if (convention.is_inverted) {
    pose = pose.inverse();
  }
  if (convention.is_back_to_front) {
    pose.matrix().middleCols<2>(1) *= -1;
  }
  return convention.is_mirrored ? with_y_down(pose) : pose;
}

/// A convention, and how far the depth images agree by it.
struct Trial {
  Convention convention = {};
  ViewAgreement agreement = {};
};

Trial try_convention(const Convention& convention, std::vector<Snapshot> views) {
  for (Snapshot& view : views) {
    view.intrinsics.depth_unit = convention.depth_unit;
    view.object_from_sensor = pose_by(convention, view.object_from_sensor);
  }
  return {.convention = convention, .agreement = compare_views(views)};
}

/// Finds the convention by which the depth images agree best: the layout's own, unless another one
/// is far better.
Trial find_convention(const std::vector<Snapshot>& views, const Trial& own,
                      std::span<const double> units) {
  constexpr double far_better = 1.5;
  constexpr double believable = 0.8;
  Trial best = own;
  double most = far_better * std::max(0.0, own.agreement.net());
  for (const double unit : units) {
    for (unsigned bits = 0; bits < 8; ++bits) {
      const Trial trial = try_convention({.depth_unit = unit,
                                          .is_inverted = (bits & 1U) != 0,
                                          .is_back_to_front = (bits & 2U) != 0,
                                          .is_mirrored = (bits & 4U) != 0},
                                         views);
      if (trial.agreement.net() > most && trial.agreement.share() > believable) {
        best = trial;
        most = trial.agreement.net();
      }
    }
  }
  return best;
}

/// Describes a convention that is not the layout's own, for people; empty for that one.
std::string describe(const Trial& found, const Trial& own) {
  std::ostringstream text;
  if (found.convention.depth_unit != own.convention.depth_unit) {
    text << "The depth unit is 1 mm, not 1/5000 m.\n";
  }
  if (found.convention.is_inverted) {
    text << "The poses were those of the world in the camera's frame: they are inverted.\n";
  }
  if (found.convention.is_back_to_front) {
    text << "The poses were of a camera whose Y points up and whose Z points back: they are "
            "turned.\n";
  }
  if (found.convention.is_mirrored) {
    text << "The poses were mirrored: the sign of their Y is changed.\n";
  }
  if (text.tellp() > 0) {
    text << "Thus " << found.agreement.agreeing << " readings agree with another depth image, and "
         << found.agreement.contradicted << " contradict one; as written, "
         << own.agreement.agreeing << " agree.\n";
  }
  return text.str();
}

/// Finds the scan's convention from its own depth images, and rewrites its poses and depth unit.
/// @return as `describe`
std::string settle_convention(const fs::path& folder, Scan& scan, bool has_unit) {
  constexpr double millimetre = 0.001;
  const std::vector<Snapshot> views = spread_views(stored_snapshots(folder, scan));
  const Trial own = try_convention({.depth_unit = scan.intrinsics.depth_unit}, views);
  std::vector<double> units{own.convention.depth_unit};
  if (!has_unit) {
    units.push_back(millimetre);
  }
  const Trial found = find_convention(views, own, units);
  scan.intrinsics.depth_unit = found.convention.depth_unit;
  for (Shot& shot : scan.shots) {
    shot.object_from_sensor = pose_by(found.convention, *shot.object_from_sensor);
  }
  std::string description = describe(found, own);
  if (description.empty() && views.size() > 1) {
    print_agreement(own.agreement);
  }
  return description;
}

}  // namespace

void import_tum(const ImportArguments& arguments) try {
  const SignalStop signal;
  if (!arguments.camera.empty()) {
    static_cast<void>(tum_camera(arguments.camera));
  }
  TumRecording recording = read_tum_recording(arguments.folder, arguments.every, arguments.max_gap);
  const std::size_t images = recording.images.size();
  const std::size_t without_pose = recording.without_pose;
  NewFolder folder(arguments.output);
  Scan scan = gather(std::move(recording), arguments, folder.path(), signal.token());
  const std::string convention =
      settle_convention(folder.path(), scan, arguments.depth_unit.has_value());
  write_scan(folder.path(), scan);
  static_cast<void>(read_scan(folder.path()));  // refuses a place or a camera beyond its limits
  folder.commit();
  std::cerr << images << " depth images imported";
  if (without_pose > 0) {
    std::cerr << "; " << without_pose << " left out, as the recording has no pose near their time";
  }
  std::cerr << ".\n" << convention;
} catch (const fs::filesystem_error& error) {
  const bool is_full = error.code() == std::errc::no_space_on_device;
  throw Error(is_full ? ErrorCode::disk_full : ErrorCode::write_failed,
              arguments.output.string() + ": " + error.code().message());
} catch (const Stopped&) {
  throw_stopped("nothing was imported");
}

}  // namespace octurn
