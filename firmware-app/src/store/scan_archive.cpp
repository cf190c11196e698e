#include "store/scan_archive.hpp"

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "octurn/error.hpp"
#include "octurn/file.hpp"
#include "octurn/json_object.hpp"
#include "octurn/png.hpp"
#include "octurn/scan_folder.hpp"
#include "octurn/sensor_map.hpp"
#include "settings/scan_settings.hpp"
#include "store/data_folder.hpp"
#include "store/job.hpp"
#include "zip_file.hpp"

namespace octurn {
namespace {

namespace fs = std::filesystem;

constexpr std::array<std::string_view, 3> single_files{"scan.json", "job.json", "sensor-map.png"};
constexpr std::string_view snapshots_prefix = "snapshots/";
constexpr std::size_t max_archived_file_bytes = std::size_t{32} << 20U;

constexpr std::size_t part_bytes = std::size_t{16} << 10U;
constexpr std::uint64_t room_bytes = std::uint64_t{8} << 20U;  // checked at a time

// Limits of an imported scan, so that its check takes up to 100 MB of memory and some minutes.
// 4,000 snapshots in 1,000 poses have 160,000 values. While an image is decoded it takes 4 bytes a
// pixel, while a sensor map is, 12.
constexpr JsonLimits scan_json_limits{.bytes = std::size_t{4} << 20U, .values = 200'000};
constexpr std::int64_t max_pixels = 4096 * 3072;  // of one image: 12 megapixels
constexpr std::int64_t max_map_pixels = 2048 * 2048;
constexpr std::int64_t max_all_pixels = 1200 * max_pixels;  // 400 stops of three pictures each

bool is_plain(char c) {
  return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '-' ||
         c == '_';
}

/// Lists the files of a scan, sorted, so that its archive is reproducible.
std::vector<std::string> list_files(const fs::path& scan) {
  std::vector<std::string> files(single_files.begin(), single_files.end());
  for (const LabelText& text : label_texts()) {
    files.emplace_back(text.file);
  }
  for (const std::string& name : names_in(scan / snapshots_prefix)) {
    files.push_back(std::string(snapshots_prefix) + name);
  }
  std::ranges::sort(files);
  std::erase_if(files, [](const std::string& name) { return !is_scan_file(name); });
  return files;
}

std::string read_file_of(const fs::path& scan, const std::string& name) {
  auto content = read_regular_file(scan / name, max_archived_file_bytes);
  if (!content) {
    throw Error(ErrorCode::scan_missing, name + " is missing");
  }
  return *std::move(content);
}

/// Reads `scan.json` with the limits of an imported scan.
Scan read_limited_scan(const fs::path& folder) {
  const std::string text = read_file_of(folder, "scan.json");
  parse_json(text, ErrorCode::scan_malformed, "scan.json", scan_json_limits);
  Scan scan = parse_scan(text);
  const auto most = static_cast<std::size_t>(stored_ranges.max_snapshots);
  if (scan.shots.size() > most) {
    throw Error(ErrorCode::scan_malformed, "it has " + std::to_string(scan.shots.size()) +
                                               " snapshots: must have at most " +
                                               std::to_string(most));
  }
  return scan;
}

/// Lists the files of a scan's snapshots, each once, although several snapshots may name it.
std::set<std::string> list_images(const Scan& scan) {
  std::set<std::string> files;
  const auto add = [&](const std::string& file) {
    files.insert(fs::path(file).lexically_normal().string());
  };
  for (const Shot& shot : scan.shots) {
    if (scan.laser) {
      std::ranges::for_each(shot.pictures, add);
    } else {
      add(shot.file);
    }
  }
  return files;
}

/// @throws Error "scan-malformed"  if images of that size take too much memory or time to check
void expect_small_images(const Scan& scan, std::size_t images, bool has_map) {
  const std::int64_t pixels = std::int64_t{scan.intrinsics.width} * scan.intrinsics.height;
  const std::int64_t most = has_map ? max_map_pixels : max_pixels;
  if (pixels > most) {
    throw Error(ErrorCode::scan_malformed,
                "its images have " + std::to_string(pixels) + " pixels: must have at most " +
                    std::to_string(most) + (has_map ? " with a sensor map" : ""));
  }
  if (pixels * static_cast<std::int64_t>(images) > max_all_pixels) {
    throw Error(ErrorCode::scan_malformed, "its " + std::to_string(images) + " images have " +
                                               std::to_string(pixels) +
                                               " pixels each: more than a scan can have");
  }
}

void decode_image(const fs::path& folder, const Scan& scan, const std::string& file) {
  const std::string png = read_file_of(folder, file);
  const auto bytes = std::as_bytes(std::span(png));
  const Intrinsics& lens = scan.intrinsics;
  if (scan.laser) {
    decode_picture_png(file, bytes, lens.width, lens.height);
  } else {
    decode_depth_png(file, bytes, lens.width, lens.height);
  }
}

/// @throws Error  if the scan is incomplete or damaged, or exceeds a limit; Stopped
void check_scan(const fs::path& folder, const std::stop_token& stop) {
  const Scan scan = read_limited_scan(folder);
  const std::set<std::string> images = list_images(scan);
  std::error_code ignored;
  const bool has_map = fs::exists(folder / sensor_map_file, ignored);
  expect_small_images(scan, images.size(), has_map);
  if (has_map) {
    read_sensor_map(folder / sensor_map_file, scan.intrinsics);
  }
  for (const Shot& shot : scan.shots) {
    model_pose(scan, shot);  // throws if it is unknown
  }
  for (const std::string& file : images) {
    throw_if_stopped(stop);
    decode_image(folder, scan, file);
  }
}

/// Maps the names in an archive to the files of its scan. An archive that was unpacked and packed
/// again may have them in a folder, and files of other programs beside them, which are left out.
/// @throws Error "bad-request"  if there is no scan.json, and as `list_zip`
ToTarget to_target(const fs::path& archive) {
  constexpr std::string_view scan_json = "scan.json";
  constexpr std::string_view of_finder = "__MACOSX/";
  const std::vector<std::string> names = list_zip(archive);
  std::optional<std::string> folder;
  for (const std::string& name : names) {
    const std::string prefix = name.substr(0, name.rfind('/') + 1);
    if (name == prefix + std::string(scan_json) && !name.starts_with(of_finder) &&
        (!folder || prefix.size() < folder->size())) {
      folder = prefix;
    }
  }
  if (!folder) {
    throw Error(
        ErrorCode::bad_request,
        "the archive has no scan.json" + (names.empty() ? std::string() : ", but " + names.front()),
        "Send a file that an Octurn has made: scan.zip.");
  }
  return [prefix = *folder](std::string_view name) -> std::optional<std::string> {
    if (!name.starts_with(prefix) || !is_scan_file(name.substr(prefix.size()))) {
      return std::nullopt;
    }
    return std::string(name.substr(prefix.size()));
  };
}

}  // namespace

bool is_scan_file(std::string_view name) {
  if (std::ranges::find(single_files, name) != single_files.end() ||
      std::ranges::find(label_texts(), name, &LabelText::file) != label_texts().end()) {
    return true;
  }
  constexpr std::string_view ending = ".png";
  if (!name.starts_with(snapshots_prefix) || !name.ends_with(ending) ||
      name.size() <= snapshots_prefix.size() + ending.size()) {
    return false;
  }
  name.remove_prefix(snapshots_prefix.size());
  name.remove_suffix(ending.size());
  return std::ranges::all_of(name, is_plain);
}

void write_scan_archive(const fs::path& scan, const fs::path& archive) {
  ZipWriter zip(archive);
  for (const std::string& name : list_files(scan)) {
    if (const auto content = read_regular_file(scan / name, max_archived_file_bytes)) {
      zip.begin(name, name.ends_with(".png") ? ZipMethod::stored : ZipMethod::deflated);
      zip.write(*content);
    }
  }
  zip.commit();
}

void receive_archive(const ArchiveSource& source, const fs::path& target,
                     const std::function<void(std::uint64_t bytes)>& check_room,
                     const std::stop_token& stop) {
  AtomicFile file(target);
  std::vector<std::byte> part(part_bytes);
  std::uint64_t bytes = 0;
  std::uint64_t room = 0;
  for (std::size_t got = 0; (got = source.read(part)) > 0; bytes += got) {
    throw_if_stopped(stop);
    if (bytes + got > room) {
      check_room(room_bytes);
      room += room_bytes;
    }
    file.write(std::span(part).first(got));
  }
  throw_if_stopped(stop);
  if (bytes != source.bytes) {
    throw Error(ErrorCode::cut_short, std::to_string(bytes) + " bytes came",
                "Send the request again.");
  }
  file.commit();
}

void check_archive_files(const fs::path& archive) { check_zip(archive, to_target(archive)); }

void read_scan_archive(const fs::path& archive, const fs::path& scan, const std::stop_token& stop) {
  unpack_zip(archive, scan, to_target(archive), {}, stop);
  try {
    check_scan(scan, stop);
  } catch (const Error& error) {
    throw Error(ErrorCode::bad_request,
                std::string("the archive is no whole scan: ") + error.what(),
                "Send a file that an Octurn has made: scan.zip.");
  }
}

}  // namespace octurn
