#include "capture/last_look.hpp"

#include <string>

#include "capture/plan.hpp"
#include "capture/take_depth_image.hpp"
#include "log.hpp"
#include "octurn/calibrate.hpp"
#include "octurn/error.hpp"
#include "octurn/scan_folder.hpp"

namespace octurn {
namespace {

void warn(const Error& error) {
  log::warning("scanner", std::string("no last look at the first stop: ") + error.what());
}

}  // namespace

std::optional<DepthFrame> retake_first_stop(Rig& rig, const ScanSettings& settings,
                                            const std::stop_token& stop,
                                            const ScanObserver& observer) try {
  const Turntable& turntable = rig.turntable();
  const std::int64_t position =
      stop_positions(turntable.position(), turntable.steps_per_turn(), 1).front();
  return take_depth_image(rig, {.index = settings.snapshots, .position = position}, settings, stop,
                          observer);
} catch (const Error& error) {
  warn(error);
  return std::nullopt;
}

void store_object_motion(const std::filesystem::path& folder, const DepthFrame& again) try {
  const Scan scan = read_scan(folder);
  const Snapshot first = read_snapshot(folder, scan, scan.shots.front());
  if (const auto move =
          measure_move(first, make_snapshot(again, scan, scan.shots.front()).frame, scan.clip)) {
    write_object_move(folder, *move);
  }
} catch (const Error& error) {
  warn(error);
}

void add_stored_move(const std::filesystem::path& folder,
                     std::vector<CalibrationFinding>& findings) {
  if (const auto move = read_object_move(folder)) {
    add_move(findings, *move);
  }
}

}  // namespace octurn
