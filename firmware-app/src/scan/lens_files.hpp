#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <string_view>

#include "octurn/lens.hpp"
#include "scan/laser_settings.hpp"

namespace octurn {

/// A camera's lens as a printed board told it, among the files of this machine:
/// `lenses/SERIAL.json`.
struct KeptLens {
  std::string serial = {};  ///< of the camera
  std::string made = {};    ///< UTC, as in ISO 8601
  CameraLens lens = {};
  CameraLens sigma = {};  ///< of its numbers
  double rms = 0;         ///< pixels
  int views = 0;          ///< of the board
};

/// Where it is. What is no letter, digit, dot, dash or underscore in the serial number becomes an
/// underscore. @param data  the data folder
std::filesystem::path lens_of(const std::filesystem::path& data, std::string_view serial);

/// Keeps what a report that was accepted tells, with the time of now.
/// @param serial  of the camera; not empty
/// @throws Error "disk-full", "write-failed"
void keep_lens(const std::filesystem::path& data, std::string_view serial,
               const LensReport& report);

/// Nothing if this machine has none. @throws Error "scan-malformed"  that names what is wrong
std::optional<KeptLens> find_lens(const std::filesystem::path& data, std::string_view serial);

/// @throws Error "write-failed"
void remove_lens(const std::filesystem::path& data, std::string_view serial);

/// The lens that the settings tell.
CameraLens told_lens(const LaserSettings& settings);

/// The lens of a camera: the kept one if it is of pictures of the told one's size, else the told
/// one. @throws Error "scan-malformed"
CameraLens lens_in_force(const std::filesystem::path& data, std::string_view serial,
                         const CameraLens& told);

/// A lens as the API, files and `--json` have it: width, height, fx, fy, cx, cy, k1, k2.
nlohmann::json to_json(const CameraLens& lens);
nlohmann::json to_json(const KeptLens& kept);
nlohmann::json to_json(const LensReport& report);

}  // namespace octurn
