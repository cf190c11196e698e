#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <string_view>

#include "octurn/lens.hpp"
#include "scan/laser_settings.hpp"

namespace octurn {

/// A camera's lens, calibrated by a printed board and stored on this machine as
/// `lenses/SERIAL.json`.
struct KeptLens {
  std::string serial = {};  ///< of the camera
  std::string made = {};    ///< UTC, as in ISO 8601
  CameraLens lens = {};
  CameraLens sigma = {};  ///< of its numbers
  double rms = 0;         ///< pixels
  int views = 0;          ///< of the board
};

/// The path of a camera's file. Characters of the serial number other than letters, digits, dots,
/// dashes and underscores become underscores. @param data  the data folder
std::filesystem::path lens_of(const std::filesystem::path& data, std::string_view serial);

/// Stores the lens of an accepted report, with the current time.
/// @param serial  of the camera; not empty
/// @throws Error "disk-full", "write-failed"
void keep_lens(const std::filesystem::path& data, std::string_view serial,
               const LensReport& report);

/// Reads a camera's file; nothing if there is none. @throws Error "scan-malformed"  with the fault
std::optional<KeptLens> find_lens(const std::filesystem::path& data, std::string_view serial);

/// @throws Error "write-failed"
void remove_lens(const std::filesystem::path& data, std::string_view serial);

/// The lens of the settings.
CameraLens told_lens(const LaserSettings& settings);

/// The lens of a camera: the stored one if its pictures have the size of the settings, else that of
/// the settings. @throws Error "scan-malformed"
CameraLens lens_in_force(const std::filesystem::path& data, std::string_view serial,
                         const CameraLens& told);

/// A lens as the API, files and `--json` have it: width, height, fx, fy, cx, cy, k1, k2.
nlohmann::json to_json(const CameraLens& lens);
nlohmann::json to_json(const KeptLens& kept);
nlohmann::json to_json(const LensReport& report);

}  // namespace octurn
