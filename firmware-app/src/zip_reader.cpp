#include "zip_reader.hpp"

#include <minizip/unzip.h>

#include <algorithm>
#include <array>
#include <memory>
#include <set>
#include <span>
#include <string>
#include <system_error>

#include "octurn/error.hpp"
#include "octurn/file.hpp"
#include "octurn/snapshot.hpp"

namespace octurn {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t max_name = 256;
constexpr std::size_t part_bytes = std::size_t{64} << 10U;
constexpr unsigned long encrypted = 1;  // bit of a file's flags

[[noreturn]] void refuse(const std::string& what) {
  throw Error(ErrorCode::bad_request, "the archive " + what,
              "Send a file that an Octurn has made: scan.zip.");
}

using OpenZip = std::unique_ptr<void, decltype(&unzClose)>;

OpenZip open_archive(const fs::path& file) {
  OpenZip zip(unzOpen64(file.c_str()), &unzClose);
  if (!zip) {
    refuse("is no zip file");
  }
  return zip;
}

/// An entry of the archive's list of files.
struct Entry {
  std::string name = {};
  std::uint64_t bytes = 0;  ///< unpacked, as declared
};

Entry read_entry(unzFile zip) {
  std::array<char, max_name + 1> name{};
  unz_file_info64 info{};
  if (unzGetCurrentFileInfo64(zip, &info, name.data(), name.size(), nullptr, 0, nullptr, 0) !=
      UNZ_OK) {
    refuse("is damaged");
  }
  if (info.size_filename > max_name || (info.flag & encrypted) != 0) {
    refuse("has a name that is too long, or is encrypted");
  }
  return {.name = {name.data(), info.size_filename}, .bytes = info.uncompressed_size};
}

/// Calls `use` for each entry of the archive.
void for_each_entry(unzFile zip, const std::function<void(const Entry& entry)>& use) {
  int status = unzGoToFirstFile(zip);
  for (; status == UNZ_OK; status = unzGoToNextFile(zip)) {
    use(read_entry(zip));
  }
  if (status != UNZ_END_OF_LIST_OF_FILE) {
    refuse("is damaged");
  }
}

void check_entries(unzFile zip, const ToTarget& to_target, const ZipLimits& limits) {
  std::set<std::string> targets;
  std::uint64_t files = 0;
  std::uint64_t left = limits.all_bytes;
  for_each_entry(zip, [&](const Entry& entry) {
    if (files++ == limits.files) {
      refuse("has more than " + std::to_string(limits.files) + " files");
    }
    const std::optional<std::string> target = to_target(entry.name);
    if (!target) {
      return;
    }
    if (!targets.insert(*target).second) {
      refuse("has " + *target + " twice");
    }
    if (entry.bytes > std::min(left, limits.file_bytes)) {
      refuse("holds more than a scan can have");
    }
    left -= entry.bytes;
  });
}

/// Unpacks the archive's current entry. @return its size, bytes
std::uint64_t unpack_here(unzFile zip, const fs::path& target, std::uint64_t max_bytes,
                          const std::stop_token& stop) {
  if (unzOpenCurrentFile(zip) != UNZ_OK) {
    refuse("is damaged");
  }
  AtomicFile file(target);
  std::array<char, part_bytes / 4> part{};
  std::uint64_t bytes = 0;
  int got = 0;
  while ((got = unzReadCurrentFile(zip, part.data(), part.size())) > 0) {
    throw_if_stopped(stop);
    bytes += static_cast<std::uint64_t>(got);
    if (bytes > max_bytes) {
      refuse("holds more than a scan can have");
    }
    file.write(std::as_bytes(std::span(part).first(static_cast<std::size_t>(got))));
  }
  if (got < 0 || unzCloseCurrentFile(zip) != UNZ_OK) {  // closing verifies the CRC-32
    refuse("is damaged");
  }
  file.commit();
  return bytes;
}

}  // namespace

std::vector<std::string> list_zip(const fs::path& archive, const ZipLimits& limits) {
  const OpenZip zip = open_archive(archive);
  std::vector<std::string> names;
  for_each_entry(zip.get(), [&](const Entry& entry) {
    if (names.size() == limits.files) {
      refuse("has more than " + std::to_string(limits.files) + " files");
    }
    names.push_back(entry.name);
  });
  return names;
}

void check_zip(const fs::path& archive, const ToTarget& to_target, const ZipLimits& limits) {
  check_entries(open_archive(archive).get(), to_target, limits);
}

void unpack_zip(const fs::path& archive, const fs::path& folder, const ToTarget& to_target,
                const ZipLimits& limits, const std::stop_token& stop) {
  const OpenZip zip = open_archive(archive);
  check_entries(zip.get(), to_target, limits);
  std::uint64_t left = limits.all_bytes;
  for_each_entry(zip.get(), [&](const Entry& entry) {
    throw_if_stopped(stop);
    const std::optional<std::string> name = to_target(entry.name);
    if (!name) {
      return;
    }
    const fs::path target = folder / *name;
    std::error_code error;
    if (fs::exists(target, error)) {
      refuse("has " + *name + " twice");
    }
    fs::create_directories(target.parent_path(), error);
    left -= unpack_here(zip.get(), target, std::min(left, limits.file_bytes), stop);
  });
}

}  // namespace octurn
