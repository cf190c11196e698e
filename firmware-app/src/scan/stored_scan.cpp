#include "scan/stored_scan.hpp"

#include <cstddef>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "log.hpp"
#include "octurn/depth_png.hpp"
#include "octurn/error.hpp"
#include "octurn/file.hpp"

namespace octurn {
namespace {

Snapshot empty_snapshot(const Scan& scan, const Shot& shot) {
  const Intrinsics& lens = scan.intrinsics;
  const auto size = static_cast<std::size_t>(lens.width) * static_cast<std::size_t>(lens.height);
  return {.frame = {.width = lens.width,
                    .height = lens.height,
                    .depth = std::vector<std::uint16_t>(size)},
          .intrinsics = lens,
          .object_from_sensor = model_pose(scan, shot),
          .pose = shot.pose};
}

/// "snapshots/000-dark.png" beside "snapshots/000.png".
std::string picture_file(const std::string& shot, const std::string& name) {
  const std::filesystem::path file(shot);
  return (file.parent_path() / (file.stem().string() + "-" + name + ".png")).string();
}

void write_picture(const std::filesystem::path& file, const Picture& picture) {
  std::error_code ignored;  // if the folder cannot be made, writing the file says why
  std::filesystem::create_directories(file.parent_path(), ignored);
  const std::vector<std::byte> png =
      encode_grey_png(picture.width, picture.height, picture.samples);
  write_file(file, {reinterpret_cast<const char*>(png.data()), png.size()});
}

}  // namespace

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
  write_depth_png(folder / shot.file, frame);
  scan.shots.push_back(shot);
  write_scan(folder, scan);
}

void store_pictures(const std::filesystem::path& folder, Scan& scan, double angle,
                    const std::vector<Picture>& pictures) {
  Shot shot{.angle = angle};
  const auto index = static_cast<int>(scan.shots.size());
  for (std::size_t i = 0; i < pictures.size(); ++i) {
    shot.pictures.push_back(
        picture_file(shot_file(index), i == 0 ? "dark" : scan.laser->lasers[i - 1].name));
    write_picture(folder / shot.pictures.back(), pictures[i]);
  }
  scan.shots.push_back(std::move(shot));
  write_scan(folder, scan);
}

}  // namespace octurn
