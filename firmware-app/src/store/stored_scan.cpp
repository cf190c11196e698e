#include "store/stored_scan.hpp"

#include <algorithm>
#include <array>
#include <fstream>
#include <system_error>
#include <utility>

#include "log.hpp"
#include "octurn/error.hpp"
#include "octurn/file.hpp"

namespace octurn {
namespace {

Snapshot empty_snapshot(const Scan& scan, const Shot& shot) {
  const Intrinsics lens = model_intrinsics(scan, shot);
  const auto size = static_cast<std::size_t>(lens.width) * static_cast<std::size_t>(lens.height);
  return {.frame = {.width = lens.width,
                    .height = lens.height,
                    .depth = std::vector<std::uint16_t>(size)},
          .intrinsics = lens,
          .object_from_sensor = model_pose(scan, shot),
          .pose = shot.pose};
}

void write_png(const std::filesystem::path& file, const std::vector<std::byte>& png) {
  // Not the folders above: somebody may have removed the scan.
  std::error_code ignored;  // if the folder cannot be made, writing the file says why
  std::filesystem::create_directory(file.parent_path(), ignored);
  write_file(file, {reinterpret_cast<const char*>(png.data()), png.size()});
}

bool is_grey(const Rgb& pixel) { return pixel[0] == pixel[1] && pixel[1] == pixel[2]; }

std::vector<std::byte> encode(const Picture& picture, const std::vector<Rgb>& colours) {
  return std::ranges::all_of(colours, is_grey)  // or there are no colours
             ? encode_grey_png(picture.width, picture.height, picture.samples)
             : encode_rgb_png(
                   {.width = picture.width, .height = picture.height, .pixels = colours});
}

bool is_same_camera(const LaserCamera& one, const LaserCamera& other) {
  return one.k1 == other.k1 && one.k2 == other.k2 &&
         std::ranges::equal(one.lasers, other.lasers, {}, &Laser::name, &Laser::name);
}

// Memory for each snapshot in addition to the reconstruction.
constexpr std::size_t check_bytes = 100'000;
constexpr std::size_t calibration_bytes = 350'000;

}  // namespace

bool have_same_sensor(const Scan& one, const Scan& other) {
  return one.intrinsics == other.intrinsics && one.laser.has_value() == other.laser.has_value() &&
         (!one.laser || is_same_camera(*one.laser, *other.laser));
}

SnapshotSource readable_snapshots(const std::filesystem::path& folder, const Scan& scan,
                                  const std::stop_token& stop) {
  return {.count = scan.shots.size(),
          .read = [scan, stored = stored_snapshots(folder, scan, stop)](std::size_t index) {
            try {
              return stored.read(index);
            } catch (const Error& error) {
              log::warning("scan", std::string("a snapshot is left out: ") + error.what());
              return empty_snapshot(scan, scan.shots[index]);
            }
          }};
}

void store_snapshot(const std::filesystem::path& folder, Scan& scan, const Shot& shot,
                    const DepthFrame& frame) {
  if (std::error_code unknown; !std::filesystem::is_directory(folder, unknown)) {
    throw Error(ErrorCode::write_failed, folder.string() + " is gone",
                "Somebody may have removed or unmounted it.");
  }
  write_depth_png(folder / shot.file, frame);
  scan.shots.push_back(shot);
  write_scan(folder, scan);
}

std::vector<std::string> picture_files(int stop, const LaserCamera& camera) {
  const std::filesystem::path file(shot_file(stop));
  const std::string stem = (file.parent_path() / file.stem()).string();
  std::vector<std::string> files{stem + "-dark.png"};
  for (const Laser& laser : camera.lasers) {
    files.push_back(stem + "-" + laser.name + ".png");
  }
  return files;
}

void write_picture(const std::filesystem::path& file, const Picture& picture,
                   const std::vector<Rgb>& colours) {
  write_png(file, encode(picture, colours));
}

void store_stop(const std::filesystem::path& folder, Scan& scan, double angle) {
  Shot shot{.angle = angle};
  shot.pictures = picture_files(static_cast<int>(scan.shots.size()), *scan.laser);
  scan.shots.push_back(std::move(shot));
  write_scan(folder, scan);
}

bool has_colours(const std::filesystem::path& folder, const Scan& scan) {
  if (!scan.laser || scan.shots.empty()) {
    return false;
  }
  // The 26th byte of a PNG, in its IHDR chunk, is the colour type.
  constexpr std::size_t kind_at = 25;
  constexpr char truecolour = 2;
  std::array<char, kind_at + 1> head{};
  std::ifstream file(folder / scan.shots.front().pictures.front(), std::ios::binary);
  return file.read(head.data(), head.size()) && head[kind_at] == truecolour;
}

Scan scan_to_build(const std::filesystem::path& folder, const BuildSettings& settings) {
  Scan scan = read_scan(folder);
  if (!scan.poses.empty()) {  // these keep their own sensor poses and clip boxes
    if (settings.platform_from_sensor) {
      throw Error(
          ErrorCode::bad_settings,
          "platform_from_sensor: a model of several poses keeps the sensor poses of its turns",
          "Leave platform_from_sensor out.");
    }
    return scan;
  }
  scan.clip = settings.scan.clip;
  if (settings.platform_from_sensor) {
    scan.platform_from_sensor = *settings.platform_from_sensor;
  }
  if (settings.platform_from_sensor || settings.scan.pose == PoseSource::configured) {
    scan.solved.reset();
  }
  return scan;
}

ModelScan scan_of_model(const ScanStore& store, const Job& job, int build) {
  if (build == 0) {
    const std::filesystem::path folder = store.folder(job.id);
    return {.folder = folder, .scan = read_scan(folder)};
  }
  const Build* const built = find_build(job, build);
  if (built == nullptr) {
    throw Error(ErrorCode::no_model, "this scan has no build " + std::to_string(build),
                "GET /api/v1/scans/ID/builds lists its builds.");
  }
  const std::filesystem::path folder = store.merged_scan(job.id, built->poses);
  ModelScan of{.folder = folder,
               .scan = scan_to_build(folder, built->settings),
               .edits = built->settings.edits.edits};
  const auto& calibration = built->calibration;
  if (calibration && calibration->accepted && !calibration->confirms_told) {
    of.scan.solved = calibration->solved;
  }
  return of;
}

ReconstructOptions checked_options(const ScanSettings& settings, const Limits& limits,
                                   std::size_t snapshots) {
  ReconstructOptions options = reconstruct_options(settings, limits);
  const std::size_t each =
      check_bytes + (settings.pose == PoseSource::solved ? calibration_bytes : 0);
  options.program_memory += each * snapshots;
  return options;
}

}  // namespace octurn
