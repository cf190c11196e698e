#include "store/model_scan.hpp"

#include <string>

#include "octurn/error.hpp"

namespace octurn {

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
  ModelScan of{.folder = folder, .scan = scan_to_build(folder, built->settings)};
  const auto& calibration = built->calibration;
  if (calibration && calibration->accepted && !calibration->confirms_told) {
    of.scan.solved = calibration->solved;
  }
  return of;
}

}  // namespace octurn
