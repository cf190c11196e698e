#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "fuzz/small_models.hpp"
#include "octurn/png.hpp"
#include "store/scan_archive.hpp"
#include "support/temporary_folder.hpp"
#include "zip_file.hpp"

// The way of an archive to a model. One that is taken has a scan whose pictures can be read, makes
// models or says why not, and is taken again after it was packed again; any other is refused by an
// Error of one line.
//
// An input is an archive, or what one of right checksums is made of: records of a file's number, a
// length (2 bytes, little-endian), and content.

namespace {

namespace fs = std::filesystem;
using octurn::require;
using octurn::require_one_line;

constexpr std::array<const char*, 9> names{
    "scan.json",         "job.json",          "name.txt", "notes.txt", "sensor-map.png",
    "snapshots/000.png", "snapshots/001.png", "a.png",    "../a.png"};
constexpr std::size_t first_picture = 5;
constexpr std::size_t last_picture = 6;

/// Takes bytes from the front.
std::string take(std::string_view& bytes, std::size_t count) {
  std::string taken(bytes.substr(0, count));
  bytes.remove_prefix(taken.size());
  return taken;
}

/// A depth image of a width in the first byte, and of the other bytes as depths.
std::string to_png(std::string_view content) {
  const int width = content.empty() ? 1 : 1 + static_cast<unsigned char>(content.front()) % 32;
  octurn::DepthFrame frame{.width = width};
  for (std::size_t i = 1; i + 1 < content.size(); i += 2) {
    frame.depth.push_back(static_cast<std::uint16_t>(
        static_cast<unsigned char>(content[i]) | static_cast<unsigned char>(content[i + 1]) << 8U));
  }
  frame.height = std::max(1, static_cast<int>(frame.depth.size()) / width);
  frame.depth.resize(static_cast<std::size_t>(width) * static_cast<std::size_t>(frame.height));
  const std::vector<std::byte> png = encode_depth_png(frame);
  return {reinterpret_cast<const char*>(png.data()), png.size()};
}

std::string to_archive(std::string_view input) {
  if (input.starts_with("PK")) {
    return std::string(input);
  }
  std::vector<octurn::ArchivedFile> files;
  while (input.size() >= 3 && files.size() < 20) {
    const std::string head = take(input, 3);
    const std::size_t name = static_cast<unsigned char>(head[0]) % names.size();
    const std::size_t length = static_cast<unsigned char>(head[1]) |
                               static_cast<std::size_t>(static_cast<unsigned char>(head[2])) << 8U;
    std::string content = take(input, length);
    const bool is_picture = name >= first_picture && name <= last_picture;
    files.push_back(
        {.name = names[name], .content = is_picture ? to_png(content) : std::move(content)});
  }
  return octurn::make_zip(files, {});
}

/// Every picture that was checked can be read.
void make_models_of(const fs::path& folder) {
  const octurn::Scan scan = octurn::read_scan(folder);
  if (!is_small(scan)) {
    return;
  }
  const octurn::SnapshotSource snapshots = stored_snapshots(folder, scan);
  try {
    make_models(scan, snapshots);
  } catch (const octurn::Error& error) {
    require_one_line(error);
    require(error.code() != octurn::ErrorCode::snapshot_malformed &&
            error.code() != octurn::ErrorCode::scan_missing);
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const octurn::TemporaryFolder folder;
  const fs::path archive = folder.path() / "scan.zip";
  const fs::path scan = folder.path() / "scan";
  const fs::path again = folder.path() / "again";
  fs::create_directory(scan);
  fs::create_directory(again);
  octurn::put(archive, to_archive({reinterpret_cast<const char*>(data), size}));
  try {
    octurn::check_archive_files(archive);
    octurn::read_scan_archive(archive, scan);
  } catch (const octurn::Error& error) {
    require_one_line(error);
    return 0;
  }
  make_models_of(scan);
  octurn::write_scan_archive(scan, archive);
  octurn::read_scan_archive(archive, again);
  require(octurn::content_of(scan / "scan.json") == octurn::content_of(again / "scan.json"));
  return 0;
}
