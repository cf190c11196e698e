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

/// A stream of the C library that writes into memory, which its end makes valid.
struct MemoryStream {
  MemoryStream() = default;
  ~MemoryStream() { std::free(bytes); }
  MemoryStream(const MemoryStream&) = delete;
  MemoryStream& operator=(const MemoryStream&) = delete;

  char* bytes = nullptr;
  std::size_t size = 0;
};

/// What minizip calls to open its file; the rest it does with streams of the C library already.
void* open_in_memory(void* stream, const char* /*name*/, int /*mode*/) noexcept {
  auto& memory = *static_cast<MemoryStream*>(stream);
  return ::open_memstream(&memory.bytes, &memory.size);
}

tm_zip date_of(system_clock::time_point time) {
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

std::string archive_of(std::span<const ArchivedFile> files, system_clock::time_point time) {
  MemoryStream memory;
  zlib_filefunc_def functions{};
  fill_fopen_filefunc(&functions);
  functions.zopen_file = open_in_memory;
  functions.opaque = &memory;
  const zip_fileinfo info{
      .tmz_date = date_of(time), .dosDate = 0, .internal_fa = 0, .external_fa = 0};

  const zipFile zip = zipOpen2("", APPEND_STATUS_CREATE, nullptr, &functions);
  if (zip == nullptr) {
    throw std::bad_alloc();
  }
  const bool added =
      std::ranges::all_of(files, [&](const ArchivedFile& file) { return add(zip, file, info); });
  if (zipClose(zip, nullptr) != ZIP_OK || !added) {  // in memory, only the lack of it can fail
    throw std::bad_alloc();
  }
  return {memory.bytes, memory.size};
}

}  // namespace

// minizip takes 70 KB of stack, and the HTTP server's threads have 100 KB.
std::string zip_of(std::span<const ArchivedFile> files, system_clock::time_point time) {
  return std::async(std::launch::async, archive_of, files, time).get();
}

}  // namespace octurn
