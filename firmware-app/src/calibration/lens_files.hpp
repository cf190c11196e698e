#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <string_view>

#include "octurn/lens.hpp"
#include "settings/laser_settings.hpp"

namespace octurn {

/// A camera's lens, calibrated with a printed board and stored on this machine as
/// `lenses/SERIAL.json`.
struct KeptLens {
  std::string serial = {};  ///< of the camera
  std::string made = {};    ///< UTC, as in ISO 8601
  CameraLens lens = {};
  CameraLens sigma = {};  ///< standard deviations of the lens's numbers
  double rms = 0;         ///< pixels, of the reprojection errors
  int views = 0;          ///< number of views of the board
};

/// The lens of a camera that was solved last, until it is kept or discarded. Its report is
/// accepted.
struct SolvedLens {
  std::string camera = {};  ///< serial number
  LensReport report = {};
  std::optional<SolvedOptics> optics = {};  ///< of a depth sensor; nullopt: a camera
};

/// Returns the path of a camera's file. Characters of the serial number other than letters, digits,
/// dots, dashes and underscores become underscores. @param data  the data folder
std::filesystem::path lens_path(const std::filesystem::path& data, std::string_view serial);

/// Stores the lens of an accepted report, with the current time.
/// @param serial  of the camera; not empty
/// @throws Error "disk-full", "write-failed"
void keep_lens(const std::filesystem::path& data, std::string_view serial,
               const LensReport& report);

/// Reads a camera's file; nullopt if there is none. @throws Error "scan-malformed"  with the fault
std::optional<KeptLens> find_lens(const std::filesystem::path& data, std::string_view serial);

/// Removes a camera's file, if there is one. @throws Error "write-failed"
void remove_lens(const std::filesystem::path& data, std::string_view serial);

/// Returns the lens of the settings.
CameraLens told_lens(const LaserSettings& settings);

/// Returns the lens to use for a camera: the stored one if it is for pictures of the settings'
/// size, else `configured`, the settings' one. @throws Error "scan-malformed"
CameraLens lens_in_force(const std::filesystem::path& data, std::string_view serial,
                         const CameraLens& configured);

/// JSON of a lens, for the API, files and `--json`: width, height, fx, fy, cx, cy, k1, k2.
nlohmann::json to_json(const CameraLens& lens);
nlohmann::json to_json(const KeptLens& kept);
nlohmann::json to_json(const LensReport& report);

}  // namespace octurn
