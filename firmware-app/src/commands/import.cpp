#include <filesystem>
#include <iostream>
#include <span>
#include <string>
#include <system_error>

#include "commands/model_commands.hpp"
#include "octurn/error.hpp"
#include "octurn/file.hpp"
#include "octurn/png.hpp"
#include "octurn/scan_folder.hpp"
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
Scan gather(const TumRecording& recording, const ImportArguments& arguments, const fs::path& folder,
            const std::stop_token& stop) {
  const std::string camera =
      arguments.camera.empty() ? std::string(to_tum_camera(arguments.folder)) : arguments.camera;
  Scan scan{
      .sensor_name = "TUM RGB-D, " + camera, .intrinsics = tum_camera(camera), .clip = everywhere};
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

}  // namespace

void import_tum(const ImportArguments& arguments) try {
  const SignalStop signal;
  if (!arguments.camera.empty()) {
    static_cast<void>(tum_camera(arguments.camera));
  }
  const TumRecording recording = read_tum_recording(arguments.folder, arguments.every);
  NewFolder folder(arguments.output);
  write_scan(folder.path(), gather(recording, arguments, folder.path(), signal.token()));
  folder.commit();
  std::cerr << recording.images.size() << " depth images imported";
  if (recording.without_pose > 0) {
    std::cerr << "; " << recording.without_pose
              << " left out, as the recording has no pose near their time";
  }
  std::cerr << ".\n";
} catch (const fs::filesystem_error& error) {
  const bool is_full = error.code() == std::errc::no_space_on_device;
  throw Error(is_full ? ErrorCode::disk_full : ErrorCode::write_failed,
              arguments.output.string() + ": " + error.code().message());
} catch (const Stopped&) {
  throw_stopped("nothing was imported");
}

}  // namespace octurn
