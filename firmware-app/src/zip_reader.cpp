#include "zip_reader.hpp"

#include <minizip/unzip.h>

#include <algorithm>
#include <array>
#include <memory>
#include <span>
#include <string>
#include <system_error>

#include "octurn/error.hpp"
#include "octurn/file.hpp"

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

/// The name of the archive's current entry.
std::string name_here(unzFile zip) {
  std::array<char, max_name + 1> name{};
  unz_file_info64 info{};
  if (unzGetCurrentFileInfo64(zip, &info, name.data(), name.size(), nullptr, 0, nullptr, 0) !=
      UNZ_OK) {
    refuse("is damaged");
  }
  if (info.size_filename > max_name || (info.flag & encrypted) != 0) {
    refuse("has a name that is too long, or is encrypted");
  }
  return {name.data(), info.size_filename};
}

/// Unpacks the archive's current entry. @return its size, bytes
std::uint64_t unpack_here(unzFile zip, const fs::path& target, std::uint64_t max_bytes) {
  if (unzOpenCurrentFile(zip) != UNZ_OK) {
    refuse("is damaged");
  }
  AtomicFile file(target);
  std::array<char, part_bytes / 4> part{};
  std::uint64_t bytes = 0;
  int got = 0;
  while ((got = unzReadCurrentFile(zip, part.data(), part.size())) > 0) {
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

void unpack_zip(const fs::path& archive, const fs::path& folder,
                const std::function<bool(std::string_view name)>& is_allowed,
                const ZipLimits& limits) {
  const std::unique_ptr<void, decltype(&unzClose)> zip(unzOpen64(archive.c_str()), &unzClose);
  if (!zip) {
    refuse("is no zip file");
  }
  std::uint64_t files = 0;
  std::uint64_t left = limits.all_bytes;
  int status = unzGoToFirstFile(zip.get());
  for (; status == UNZ_OK; status = unzGoToNextFile(zip.get())) {
    const std::string name = name_here(zip.get());
    const fs::path target = folder / name;
    std::error_code error;
    if (!is_allowed(name) || fs::exists(target, error) || ++files > limits.files) {
      refuse("has a file that belongs to no scan, or one twice");
    }
    fs::create_directories(target.parent_path(), error);
    left -= unpack_here(zip.get(), target, std::min(left, limits.file_bytes));
  }
  if (status != UNZ_END_OF_LIST_OF_FILE) {
    refuse("is damaged");
  }
}

}  // namespace octurn
