#include "store/data_folder.hpp"

#include <fcntl.h>
#include <sys/file.h>

#include <cerrno>
#include <cmath>
#include <string_view>

#include "octurn/error.hpp"
#include "octurn/units.hpp"
#include "settings/field.hpp"

namespace octurn {
namespace {

namespace fs = std::filesystem;

// Upper bounds: an uncompressed 16-bit depth image, and a fine model.
constexpr std::uint64_t snapshot_bytes = std::uint64_t{640} * 480 * 2;
constexpr std::uint64_t model_bytes = std::uint64_t{128} << 20U;

std::error_code last_error() { return {errno, std::generic_category()}; }

/// Opens the folder itself, to be locked. A lock file could be refused by a full, read-only or
/// failing disk, or be deleted.
FileDescriptor open_folder(const fs::path& data) {
  return FileDescriptor(::open(data.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
}

/// Whether this is a name that `temporary_name` makes of a JSON file: ".platform.json.1234-0".
bool is_unfinished_json(std::string_view name) {
  constexpr std::string_view ending = ".json.";
  const std::size_t numbers = name.rfind(ending);
  return name.starts_with('.') && numbers != name.npos &&
         name.substr(numbers + ending.size()).find_first_not_of("0123456789-") == name.npos;
}

}  // namespace

void throw_data_error(const fs::path& path, const std::string& doing, std::error_code reason) {
  const bool full = reason == std::errc::no_space_on_device;
  throw Error(
      full ? ErrorCode::disk_full : ErrorCode::data_failed,
      path.string() + ": cannot " + doing + ": " + reason.message(),
      full ? "Delete scans that are no longer needed."
           : "Check that this program may write there, or choose another folder with --data.",
      {{"path", path.string()}});
}

std::uint64_t max_scan_bytes(const ScanSettings& settings) {
  return model_bytes + snapshot_bytes * static_cast<std::uint64_t>(settings.snapshots);
}

std::uint64_t max_model_bytes() { return model_bytes; }

void expect_room(const fs::path& data, std::uint64_t available, std::uint64_t needed,
                 const std::string& what) {
  if (available < needed) {
    const auto mb = [](std::uint64_t bytes) {
      return std::floor(mb_from_bytes(static_cast<double>(bytes)));
    };
    throw Error(ErrorCode::disk_full,
                whole_mb_text(available) + " free in " + data.string() + ", " + what + " needs " +
                    whole_mb_text(needed),
                "Delete scans that are no longer needed, and empty the bin.",
                {{"free_mb", mb(available)}, {"needed_mb", mb(needed)}, {"path", data.string()}});
  }
}

fs::path existing_part(fs::path folder) {
  std::error_code ignored;
  while (!folder.empty() && !fs::exists(folder, ignored) && folder != folder.parent_path()) {
    folder = folder.parent_path();
  }
  return folder.empty() ? fs::path(".") : folder;
}

std::uint64_t free_bytes_in(const fs::path& folder) {
  std::error_code error;
  const fs::space_info space = fs::space(existing_part(folder), error);
  if (error) {
    throw_data_error(folder, "read", error);
  }
  return space.available;
}

bool is_in_use(const fs::path& data) {
  const FileDescriptor lock = open_folder(data);
  return lock.is_open() && ::flock(lock.number(), LOCK_SH | LOCK_NB) != 0;
}

FileDescriptor lock_data_folder(const fs::path& data) {
  FileDescriptor lock = open_folder(data);
  if (!lock.is_open()) {
    throw_data_error(data, "open", last_error());
  }
  if (::flock(lock.number(), LOCK_EX | LOCK_NB) == 0) {
    return lock;
  }
  if (errno != EWOULDBLOCK) {
    throw_data_error(data, "lock", last_error());
  }
  throw Error(ErrorCode::data_in_use, data.string() + ": another octurn works in this folder",
              "End it first, or choose another folder with --data.");
}

std::vector<std::string> names_in(const fs::path& folder) {
  std::vector<std::string> names;
  std::error_code error;
  fs::directory_iterator entry(folder, error);
  while (!error && entry != fs::directory_iterator()) {
    names.push_back(entry->path().filename().string());
    entry.increment(error);
  }
  return names;
}

void clear_unfinished(const fs::path& folder) {
  std::error_code ignored;  // leftovers are harmless
  for (const std::string& name : names_in(folder)) {
    if (name.starts_with('.')) {
      fs::remove_all(folder / name, ignored);
    }
  }
}

void clear_unfinished_json(const fs::path& data) {
  std::error_code ignored;
  for (const std::string& name : names_in(data)) {
    if (is_unfinished_json(name)) {
      fs::remove(data / name, ignored);
    }
  }
}

}  // namespace octurn
