#include "scan/stored_scan.hpp"

#include <string>
#include <vector>

#include "log.hpp"
#include "octurn/depth_png.hpp"
#include "octurn/error.hpp"

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

}  // namespace octurn
