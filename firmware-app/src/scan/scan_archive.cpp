#include "scan/scan_archive.hpp"

#include <algorithm>
#include <array>
#include <stop_token>
#include <string>
#include <vector>

#include "octurn/error.hpp"
#include "octurn/file.hpp"
#include "octurn/scan_folder.hpp"
#include "scan/data_folder.hpp"
#include "zip_reader.hpp"
#include "zip_writer.hpp"

namespace octurn {
namespace {

namespace fs = std::filesystem;

constexpr std::array<std::string_view, 5> single_files{"scan.json", "job.json", "name.txt",
                                                       "notes.txt", "sensor-map.png"};
constexpr std::string_view snapshots_prefix = "snapshots/";
constexpr std::size_t max_archived_file_bytes = std::size_t{32} << 20U;

bool is_plain(char c) {
  return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '-' ||
         c == '_';
}

/// Lists the files of a scan, sorted, so that its archive is reproducible.
std::vector<std::string> list_files(const fs::path& scan) {
  std::vector<std::string> files(single_files.begin(), single_files.end());
  for (const std::string& name : names_in(scan / snapshots_prefix)) {
    files.push_back(std::string(snapshots_prefix) + name);
  }
  std::ranges::sort(files);
  std::erase_if(files, [](const std::string& name) { return !is_scan_file(name); });
  return files;
}

}  // namespace

bool is_scan_file(std::string_view name) {
  if (std::ranges::find(single_files, name) != single_files.end()) {
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

void read_scan_archive(const fs::path& archive, const fs::path& scan) {
  unpack_zip(archive, scan, is_scan_file);
  try {
    const Scan read = read_scan(scan);
    const SnapshotSource stored = stored_snapshots(scan, read, {});
    for (std::size_t i = 0; i < stored.count; ++i) {
      stored.read(i);
    }
    if (stored.count == 0) {
      throw Error(ErrorCode::bad_request, "there is no snapshot in it");
    }
  } catch (const Error& error) {
    throw Error(ErrorCode::bad_request,
                std::string("the archive is no whole scan: ") + error.what(),
                "Send a file that an Octurn has made: scan.zip.");
  }
}

}  // namespace octurn
