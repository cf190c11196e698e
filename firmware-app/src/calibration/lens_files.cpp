#include "calibration/lens_files.hpp"

#include <algorithm>
#include <chrono>
#include <nlohmann/json.hpp>
#include <system_error>

#include "calibration/record_file.hpp"
#include "calibration/sensor_map_files.hpp"
#include "octurn/error.hpp"
#include "octurn/intrinsics_json.hpp"
#include "octurn/json_object.hpp"
#include "octurn/units.hpp"
#include "wall_clock.hpp"

namespace octurn {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr std::string_view lens_format = "octurn-lens";
constexpr std::size_t max_lens_bytes = std::size_t{1} << 16U;
constexpr int max_views = 100000;

json to_numbers(const CameraLens& lens) {
  const Intrinsics& in = lens.intrinsics;
  return {{"fx", in.fx}, {"fy", in.fy},   {"cx", in.cx},
          {"cy", in.cy}, {"k1", lens.k1}, {"k2", lens.k2}};
}

CameraLens to_lens(JsonObject& keys) {
  return {.intrinsics = lens_from(keys),
          .k1 = keys.at("k1").number(-max_distortion, max_distortion),
          .k2 = keys.at("k2").number(-max_distortion, max_distortion)};
}

/// Reads the sigmas of a lens.
CameraLens to_sigma(JsonObject& keys) {
  return {.intrinsics = {.fx = keys.at("fx").number(0, max_focal),
                         .fy = keys.at("fy").number(0, max_focal),
                         .cx = keys.at("cx").number(0, max_focal),
                         .cy = keys.at("cy").number(0, max_focal)},
          .k1 = keys.at("k1").number(0, max_distortion),
          .k2 = keys.at("k2").number(0, max_distortion)};
}

KeptLens to_kept_lens(JsonObject& keys) {
  JsonObject sigma(keys.at("sigma"));
  KeptLens kept{.serial = keys.at("serial").text(),
                .made = keys.at("at").text(),
                .lens = to_lens(keys),
                .sigma = to_sigma(sigma),
                .rms = keys.at("rms_px").number(0, max_image_side),
                .views = keys.at("views").whole_number(0, max_views)};
  kept.lens.intrinsics.width = keys.at("width").whole_number(2, max_image_side);
  kept.lens.intrinsics.height = keys.at("height").whole_number(2, max_image_side);
  return kept;
}

}  // namespace

fs::path lens_path(const fs::path& data, std::string_view serial) {
  return data / "lenses" / sensor_map_path(data, serial).filename().replace_extension(".json");
}

void keep_lens(const fs::path& data, std::string_view serial, const LensReport& report) {
  write_record_file(lens_path(data, serial), lens_format,
                    to_json(KeptLens{.serial = std::string(serial),
                                     .made = utc_text(std::chrono::system_clock::now(), rfc3339),
                                     .lens = report.lens,
                                     .sigma = report.sigma,
                                     .rms = report.rms,
                                     .views = report.views}));
}

std::optional<KeptLens> find_lens(const fs::path& data, std::string_view serial) {
  return serial.empty() ? std::nullopt
                        : read_record({.file = lens_path(data, serial),
                                       .format = lens_format,
                                       .max_bytes = max_lens_bytes,
                                       .malformed = ErrorCode::scan_malformed},
                                      to_kept_lens);
}

void remove_lens(const fs::path& data, std::string_view serial) {
  std::error_code failed;
  const fs::path file = lens_path(data, serial);
  fs::remove(file, failed);
  if (failed) {
    throw Error(ErrorCode::write_failed, file.string() + ": cannot be removed: " + failed.message(),
                "Look at the disk.");
  }
}

CameraLens told_lens(const LaserSettings& settings) {
  return {.intrinsics = settings.lens, .k1 = settings.k1, .k2 = settings.k2};
}

CameraLens lens_in_force(const fs::path& data, std::string_view serial,
                         const CameraLens& configured) {
  const std::optional<KeptLens> kept = find_lens(data, serial);
  const bool fits = kept && kept->lens.intrinsics.width == configured.intrinsics.width &&
                    kept->lens.intrinsics.height == configured.intrinsics.height;
  if (!fits) {
    return configured;
  }
  CameraLens lens = kept->lens;
  lens.intrinsics.depth_unit = configured.intrinsics.depth_unit;  // a camera's lens has none
  return lens;
}

json to_json(const CameraLens& lens) {
  json object = to_numbers(lens);
  object["width"] = lens.intrinsics.width;
  object["height"] = lens.intrinsics.height;
  return object;
}

json to_json(const KeptLens& kept) {
  json object = to_json(kept.lens);
  object["serial"] = kept.serial;
  object["at"] = kept.made;
  object["sigma"] = to_numbers(kept.sigma);
  object["rms_px"] = kept.rms;
  object["views"] = kept.views;
  return object;
}

json to_json(const LensReport& report) {
  const bool is_solved = report.lens.intrinsics.fx > 0 && report.corners > 0;
  const double cells = static_cast<double>(std::ranges::count(report.coverage, true));
  return {{"accepted", report.accepted},
          {"reason", report.reason},
          {"lens", is_solved ? to_json(report.lens) : json()},
          {"sigma", is_solved ? to_numbers(report.sigma) : json()},
          {"rms_px", is_solved ? json(report.rms) : json()},
          {"tilt_deg", is_solved ? json(degrees_from_radians(report.tilt)) : json()},
          {"coverage", cells / static_cast<double>(report.coverage.size())},
          {"views", report.views},
          {"corners", report.corners}};
}

}  // namespace octurn
