#include "zip_archive.hpp"

#include <minizip/zip.h>

#include <algorithm>
#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <future>
#include <new>

namespace octurn {
namespace {

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

}  // namespace

// Runs on its own thread: minizip uses 70 KB of stack, and the HTTP server's threads have 100 KB.
std::string make_zip(std::span<const ArchivedFile> files, system_clock::time_point time) {
  return std::async(std::launch::async, write_archive, files, time).get();
}

}  // namespace octurn
