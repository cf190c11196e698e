#include "zip_file.hpp"

#include <fcntl.h>
#include <minizip/unzip.h>
#include <minizip/zip.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <future>
#include <new>
#include <set>
#include <system_error>
#include <utility>

#include "file_descriptor.hpp"
#include "octurn/error.hpp"
#include "octurn/file.hpp"
#include "octurn/snapshot.hpp"

namespace octurn {
namespace {

namespace fs = std::filesystem;

using std::chrono::system_clock;

/// Memory of an open_memstream(3); valid once that stream is closed.
struct MemoryStream {
  MemoryStream() = default;
  ~MemoryStream() { std::free(bytes); }
  MemoryStream(const MemoryStream&) = delete;
  MemoryStream& operator=(const MemoryStream&) = delete;

  char* bytes = nullptr;
  std::size_t size = 0;
};

/// minizip's callback that opens the archive. Its other callbacks work on any stdio stream.
void* open_in_memory(void* stream, const char* /*name*/, int /*mode*/) noexcept {
  auto& memory = *static_cast<MemoryStream*>(stream);
  return ::open_memstream(&memory.bytes, &memory.size);
}

tm_zip to_zip_date(system_clock::time_point time) {
  using namespace std::chrono;
  const auto seconds =
      std::max(floor<std::chrono::seconds>(time), sys_seconds(sys_days(year(1980) / January / 1)));
  const auto day = floor<days>(seconds);
  const year_month_day date(day);
  const hh_mm_ss clock(seconds - day);
  tm_zip all{};
  all.tm_sec = static_cast<decltype(all.tm_sec)>(clock.seconds().count());
  all.tm_min = static_cast<decltype(all.tm_min)>(clock.minutes().count());
  all.tm_hour = static_cast<decltype(all.tm_hour)>(clock.hours().count());
  all.tm_mday = static_cast<decltype(all.tm_mday)>(static_cast<unsigned>(date.day()));
  all.tm_mon = static_cast<decltype(all.tm_mon)>(static_cast<unsigned>(date.month()) - 1);
  all.tm_year = static_cast<decltype(all.tm_year)>(static_cast<int>(date.year()));
  return all;
}

bool add(zipFile zip, const ArchivedFile& file, const zip_fileinfo& info) {
  return zipOpenNewFileInZip(zip, file.name.c_str(), &info, nullptr, 0, nullptr, 0, nullptr,
                             Z_DEFLATED, Z_DEFAULT_COMPRESSION) == ZIP_OK &&
         zipWriteInFileInZip(zip, file.content.data(),
                             static_cast<unsigned>(file.content.size())) == ZIP_OK &&
         zipCloseFileInZip(zip) == ZIP_OK;
}

std::string write_archive(std::span<const ArchivedFile> files, system_clock::time_point time) {
  MemoryStream memory;
  zlib_filefunc_def functions{};
  fill_fopen_filefunc(&functions);
  functions.zopen_file = open_in_memory;
  functions.opaque = &memory;
  const zip_fileinfo info{
      .tmz_date = to_zip_date(time), .dosDate = 0, .internal_fa = 0, .external_fa = 0};

  const zipFile zip = zipOpen2("", APPEND_STATUS_CREATE, nullptr, &functions);
  if (zip == nullptr) {
    throw std::bad_alloc();
  }
  const bool added =
      std::ranges::all_of(files, [&](const ArchivedFile& file) { return add(zip, file, info); });
  if (zipClose(zip, nullptr) != ZIP_OK || !added) {  // writing to memory fails only if none is left
    throw std::bad_alloc();
  }
  return {memory.bytes, memory.size};
}

[[noreturn]] void throw_full(const fs::path& file) {
  throw Error(ErrorCode::disk_full, file.string() + ": cannot be written",
              "Delete scans that are no longer needed.", {{"path", file.string()}});
}

}  // namespace

// Runs on its own thread: minizip uses 70 KB of stack, and the HTTP server's threads have 100 KB.
std::string make_zip(std::span<const ArchivedFile> files, system_clock::time_point time) {
  return std::async(std::launch::async, write_archive, files, time).get();
}

namespace {

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

constexpr unsigned long utf8_names = 1UL << 11U;  // APPNOTE.TXT, section 4.4.4, bit 11

struct ZipWriter::Archive {
  zipFile zip = nullptr;
  bool has_file = false;

  /// Closes the open file, if there is one. @return false if that failed
  bool close_file() { return !std::exchange(has_file, false) || zipCloseFileInZip(zip) == ZIP_OK; }
  bool close() {
    const bool closed = close_file();
    return zipClose(std::exchange(zip, nullptr), nullptr) == ZIP_OK && closed;
  }
};

ZipWriter::ZipWriter(fs::path target)
    : target_(std::move(target)),
      temporary_(temporary_name(target_, 0)),
      archive_(std::make_unique<Archive>()) {
  archive_->zip = zipOpen64(temporary_.c_str(), APPEND_STATUS_CREATE);
  if (archive_->zip == nullptr) {
    throw Error(ErrorCode::write_failed, temporary_.string() + ": cannot be made",
                "Check that this program may write there.");
  }
}

ZipWriter::~ZipWriter() {
  if (archive_->zip != nullptr) {
    archive_->close();
  }
  std::error_code ignored;
  fs::remove(temporary_, ignored);
}

void ZipWriter::begin(const std::string& name, ZipMethod method) {
  zip_fileinfo info{};
  info.tmz_date = {
      .tm_sec = 0, .tm_min = 0, .tm_hour = 0, .tm_mday = 1, .tm_mon = 0, .tm_year = 1980};
  const bool is_ascii = std::ranges::none_of(name, [](char c) { return (c & 0x80) != 0; });
  const bool begun =
      archive_->close_file() &&
      zipOpenNewFileInZip4_64(archive_->zip, name.c_str(), &info, nullptr, 0, nullptr, 0, nullptr,
                              method == ZipMethod::stored ? 0 : Z_DEFLATED, Z_DEFAULT_COMPRESSION,
                              0, -MAX_WBITS, DEF_MEM_LEVEL, Z_DEFAULT_STRATEGY, nullptr, 0, 0,
                              is_ascii ? 0 : utf8_names, 0) == ZIP_OK;
  if (!begun) {
    throw_full(temporary_);
  }
  archive_->has_file = true;
}

void ZipWriter::write(std::string_view bytes) {
  if (zipWriteInFileInZip(archive_->zip, bytes.data(), static_cast<unsigned>(bytes.size())) !=
      ZIP_OK) {
    throw_full(temporary_);
  }
}

void ZipWriter::commit() {
  if (!archive_->close()) {
    throw_full(temporary_);
  }
  const FileDescriptor file(::open(temporary_.c_str(), O_RDONLY | O_CLOEXEC));
  std::error_code error;
  if (!file.is_open() || ::fsync(file.number()) != 0) {
    throw_full(temporary_);
  }
  fs::rename(temporary_, target_, error);
  if (error) {
    throw_full(target_);
  }
  sync_folder(target_.parent_path());
}

}  // namespace octurn
