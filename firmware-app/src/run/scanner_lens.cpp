// Scanner: the lens of a camera with lasers.

#include <filesystem>
#include <mutex>
#include <string>
#include <system_error>

#include "calibration/lens_files.hpp"
#include "octurn/error.hpp"
#include "run/scanner.hpp"

namespace octurn {

bool Scanner::look_at_board() {
  return begin({.kind = CalibrationRun::Kind::lens, .phase = CalibrationRun::Phase::looking},
               LensCommand{});
}

bool Scanner::solve_lens() {
  const std::lock_guard lock(scans_);
  return slot_.solve_lens();
}

/// Checks that a lens waits to be kept; `scans_` is held. @throws Error "not-found"
void Scanner::expect_solved_lens() const {
  if (!solved_lens_) {
    throw Error(ErrorCode::not_found, "no lens was found that could be kept",
                "POST /api/v1/calibration with the kind \"lens\" looks for one.");
  }
}

void Scanner::keep_lens() {
  const std::lock_guard lock(scans_);
  expect_solved_lens();
  const std::string& camera = solved_lens_->camera;
  octurn::keep_lens(store_.data(), camera, solved_lens_->report);
  if (sensor_serial() == camera) {
    board_.set_lens(find_lens(store_.data(), camera));
  }
  solved_lens_.reset();
  board_.forget_calibration_run();
}

void Scanner::discard_lens() {
  const std::lock_guard lock(scans_);
  expect_solved_lens();
  solved_lens_.reset();
  board_.forget_calibration_run();
}

void Scanner::forget_lens() {
  const std::lock_guard lock(scans_);
  const std::string serial = sensor_serial();
  std::error_code unreadable;
  if (serial.empty() || !std::filesystem::exists(lens_path(store_.data(), serial), unreadable)) {
    throw Error(ErrorCode::not_found, "no measured lens of this camera is kept",
                "The lens of the settings is in use.");
  }
  remove_lens(store_.data(), serial);
  board_.set_lens(std::nullopt);
}

}  // namespace octurn
