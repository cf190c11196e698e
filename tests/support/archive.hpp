#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "octurn/png.hpp"
#include "octurn/scan_folder.hpp"
#include "store/scan_archive.hpp"
#include "support/temporary_folder.hpp"
#include "zip_file.hpp"

namespace octurn {

/// The archive of a scan folder.
inline std::string archive_of(const std::filesystem::path& scan) {
  const TemporaryFolder folder;
  write_scan_archive(scan, folder.path() / "scan.zip");
  return content_of(folder.path() / "scan.zip");
}

/// The scan.json of a scan with that many snapshots of an image size, each with its own file.
inline nlohmann::json scan_json_of(int snapshots, int width, int height) {
  nlohmann::json scan = nlohmann::json::parse(R"({"format": "octurn-scan", "version": 1,
    "sensor": {"name": "test", "fx": 575.8, "fy": 575.8, "cx": 1.5, "cy": 1.0,
               "depth_unit_m": 0.0001},
    "calibration": {"platform_from_sensor":
      [[1, 0, 0, 0], [0, -1, 0, 0], [0, 0, -1, 0.7], [0, 0, 0, 1]]},
    "clip_m": {"min": [-0.14, -0.14, 0.005], "max": [0.14, 0.14, 0.4]}, "snapshots": []})");
  scan["sensor"]["width"] = width;
  scan["sensor"]["height"] = height;
  for (int i = 0; i < snapshots; ++i) {
    scan["snapshots"].push_back({{"file", shot_file(i)}, {"angle_deg", i * 360.0 / snapshots}});
  }
  return scan;
}

inline std::string text_of(const std::vector<std::byte>& bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

/// A depth image in which everything is 0.7 m away.
inline std::string depth_png_of(int width, int height) {
  const auto pixels = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  return text_of(encode_depth_png(
      {.width = width, .height = height, .depth = std::vector<std::uint16_t>(pixels, 7000)}));
}

/// The files of such a scan, with the same image for each snapshot.
inline std::vector<ArchivedFile> scan_files_of(int snapshots, int width, int height) {
  std::vector<ArchivedFile> files{{"scan.json", scan_json_of(snapshots, width, height).dump()}};
  const std::string png = depth_png_of(width, height);
  for (int i = 0; i < snapshots; ++i) {
    files.push_back({shot_file(i), png});
  }
  return files;
}

/// A source of an archive's bytes. @param at_end  called when all are read
inline ArchiveSource source_of(
    std::string bytes, std::function<void()> at_end = [] {}) {
  const auto left = std::make_shared<std::string>(std::move(bytes));
  return {.bytes = left->size(),
          .read = [left, at_end = std::move(at_end)](std::span<std::byte> buffer) {
            const std::size_t count = std::min(buffer.size(), left->size());
            std::ranges::copy(std::as_bytes(std::span(*left)).first(count), buffer.begin());
            left->erase(0, count);
            if (left->empty()) {
              at_end();
            }
            return count;
          }};
}

}  // namespace octurn
