// Scanner: the lens of a camera with lasers.

#include "octurn/error.hpp"
#include "scan/lens_files.hpp"
#include "scan/scanner.hpp"

namespace octurn {

bool Scanner::look_at_board() {
  return begin({.kind = CalibrationRun::Kind::lens, .phase = CalibrationRun::Phase::looking},
               LensCommand{});
}

bool Scanner::solve_lens() {
  const std::lock_guard lock(scans_);
  const auto run = calibration_run();
  const bool is_looking = status().is_measuring && *run &&
                          (*run)->kind == CalibrationRun::Kind::lens && (*run)->stop > 0;
  if (is_looking) {
    slot_.stop_scan(ScanStop::pause);
  }
  return is_looking;
}

/// Returns the last run if its lens was accepted. @throws Error "not-found"
CalibrationRun Scanner::found_lens() const {
  const auto run = calibration_run();
  if (!*run || !(*run)->lens || !(*run)->lens->accepted) {
    throw Error(ErrorCode::not_found, "no lens was found that could be kept",
                "POST /api/v1/calibration with the kind \"lens\" looks for one.");
  }
  return **run;
}

void Scanner::keep_lens() {
  const std::lock_guard lock(scans_);
  const CalibrationRun run = found_lens();
  octurn::keep_lens(store_.data(), run.camera, *run.lens);
  if (known_sensor()->serial == run.camera) {
    board_.set_lens(find_lens(store_.data(), run.camera));
  }
  board_.forget_calibration_run();
}

void Scanner::discard_lens() {
  const std::lock_guard lock(scans_);
  found_lens();
  board_.forget_calibration_run();
}

void Scanner::forget_lens() {
  const std::lock_guard lock(scans_);
  const auto sensor = known_sensor();
  if (!sensor->lens) {
    throw Error(ErrorCode::not_found, "no lens of this camera is kept", "The settings' holds.");
  }
  remove_lens(store_.data(), sensor->serial);
  board_.set_lens(std::nullopt);
}

}  // namespace octurn
