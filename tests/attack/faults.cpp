// A library that a test preloads into the daemon (LD_PRELOAD). It makes chosen system calls on the
// files of one folder fail, as a full disk or a bad sector would, lets the time of day jump, and
// gives the folder a disk of its own.
//
// A mapped file of eight 64-bit numbers selects the failures, and the test may write it at any
// moment. Its path is in the environment variable OCTURN_FAULTS, the folder's in
// OCTURN_FAULTS_FOLDER.

#include <dirent.h>
#include <dlfcn.h>
#include <fcntl.h>
#include <ftw.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <sys/time.h>
#include <sys/uio.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <cstdarg>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <string>
#include <string_view>

namespace {

/// The file's content. The test writes all but `seen` and `failed`, which it reads.
struct Faults {
  std::uint64_t calls;              // the calls that may fail, bits of Call
  std::uint64_t error;              // errno of a failing call
  std::uint64_t first;              // number of the first such call that fails, from 1
  std::uint64_t count;              // number of calls that fail
  std::atomic<std::uint64_t> seen;  // such calls so far
  std::atomic<std::uint64_t> failed;
  std::int64_t clock_seconds;  // added to the time of day
  std::uint64_t disk_bytes;    // size of a disk that only the folder is on; 0: the real one's
};

enum Call : std::uint64_t {
  write_call = 1,
  sync_call = 2,
  rename_call = 4,
  open_call = 8,
  read_call = 16,
  change_call = 32
};

template <typename Function>
Function* next(const char* name) {
  return reinterpret_cast<Function*>(::dlsym(RTLD_NEXT, name));
}

Faults* map_faults() {
  const char* const path = std::getenv("OCTURN_FAULTS");
  const int file = path != nullptr ? next<int(const char*, int, ...)>("open")(path, O_RDWR) : -1;
  if (file < 0) {
    return nullptr;
  }
  void* const memory = ::mmap(nullptr, sizeof(Faults), PROT_READ | PROT_WRITE, MAP_SHARED, file, 0);
  ::close(file);
  return memory == MAP_FAILED ? nullptr : static_cast<Faults*>(memory);
}

// Null until the library is initialised. A sanitizer opens and writes files before that, without an
// environment.
Faults* const mapped_faults = map_faults();
const char* const folder_path = std::getenv("OCTURN_FAULTS_FOLDER");

Faults* faults() { return mapped_faults; }

std::string_view folder() { return folder_path != nullptr ? folder_path : ""; }

bool is_ours(std::string_view path) {
  return !folder().empty() && path.substr(0, folder().size()) == folder();
}

bool is_ours(int file) {
  std::array<char, 32> link{};
  std::snprintf(link.data(), link.size(), "/proc/self/fd/%d", file);
  std::array<char, 4096> path{};
  const ssize_t length = ::readlink(link.data(), path.data(), path.size());
  return length > 0 && is_ours(std::string_view(path.data(), static_cast<std::size_t>(length)));
}

/// Whether this call must fail; sets errno then.
template <typename Place>
bool fails(Call call, Place place) {
  Faults* const told = faults();
  if (told == nullptr || (told->calls & call) == 0 || !is_ours(place)) {
    return false;
  }
  const std::uint64_t number = ++told->seen;
  if (number < told->first || number - told->first >= told->count) {
    return false;
  }
  ++told->failed;
  errno = static_cast<int>(told->error);
  return true;
}

/// Classifies an open. A full disk refuses to create files but opens existing ones; a read-only
/// disk opens existing ones for reading only.
Call to_call(const char* path, int flags) {
  if ((flags & O_CREAT) != 0 && ::access(path, F_OK) != 0) {
    return write_call;
  }
  return (flags & (O_WRONLY | O_RDWR)) != 0 ? change_call : open_call;
}

thread_local std::uint64_t taken_bytes = 0;

int add_taken(const char* /*path*/, const struct stat* file, int /*type*/, FTW* /*place*/) {
  taken_bytes += static_cast<std::uint64_t>(file->st_blocks) * 512;
  return 0;
}

/// What is free on a disk that only the folder is on.
std::uint64_t free_of(std::uint64_t disk_bytes) {
  taken_bytes = 0;
  ::nftw(folder_path, add_taken, 16, FTW_PHYS);
  return disk_bytes - std::min(taken_bytes, disk_bytes);
}

}  // namespace

// Functions with the names and types of the C library's.
// NOLINTBEGIN(readability-identifier-naming)
extern "C" {

ssize_t write(int file, const void* bytes, size_t size) {
  static auto* const real = next<ssize_t(int, const void*, size_t)>("write");
  return fails(write_call, file) ? -1 : real(file, bytes, size);
}

ssize_t pwrite(int file, const void* bytes, size_t size, off_t offset) {
  static auto* const real = next<ssize_t(int, const void*, size_t, off_t)>("pwrite");
  return fails(write_call, file) ? -1 : real(file, bytes, size, offset);
}

ssize_t pwrite64(int file, const void* bytes, size_t size, off64_t offset) {
  return ::pwrite(file, bytes, size, offset);
}

ssize_t writev(int file, const iovec* parts, int count) {
  static auto* const real = next<ssize_t(int, const iovec*, int)>("writev");
  return fails(write_call, file) ? -1 : real(file, parts, count);
}

int fsync(int file) {
  static auto* const real = next<int(int)>("fsync");
  return fails(sync_call, file) ? -1 : real(file);
}

int fdatasync(int file) {
  static auto* const real = next<int(int)>("fdatasync");
  return fails(sync_call, file) ? -1 : real(file);
}

int rename(const char* from, const char* to) noexcept {
  static auto* const real = next<int(const char*, const char*)>("rename");
  return fails(rename_call, std::string_view(to)) ? -1 : real(from, to);
}

int mkdir(const char* path, mode_t mode) noexcept {
  static auto* const real = next<int(const char*, mode_t)>("mkdir");
  return fails(write_call, std::string_view(path)) ? -1 : real(path, mode);
}

int open(const char* path, int flags, ...) {
  static auto* const real = next<int(const char*, int, ...)>("open");
  va_list more;
  va_start(more, flags);
  const mode_t mode = (flags & (O_CREAT | O_TMPFILE)) != 0 ? va_arg(more, mode_t) : 0;
  va_end(more);
  return fails(to_call(path, flags), std::string_view(path)) ? -1 : real(path, flags, mode);
}

int open64(const char* path, int flags, ...) {
  va_list more;
  va_start(more, flags);
  const mode_t mode = (flags & (O_CREAT | O_TMPFILE)) != 0 ? va_arg(more, mode_t) : 0;
  va_end(more);
  return ::open(path, flags, mode);
}

FILE* fopen64(const char* path, const char* mode) {
  static auto* const real = next<FILE*(const char*, const char*)>("fopen64");
  const int flags =
      std::string_view(mode).find('w') != std::string_view::npos ? O_CREAT | O_WRONLY : 0;
  return fails(to_call(path, flags), std::string_view(path)) ? nullptr : real(path, mode);
}

FILE* fopen(const char* path, const char* mode) { return ::fopen64(path, mode); }

DIR* opendir(const char* path) {
  static auto* const real = next<DIR*(const char*)>("opendir");
  return fails(open_call, std::string_view(path)) ? nullptr : real(path);
}

ssize_t read(int file, void* bytes, size_t size) {
  static auto* const real = next<ssize_t(int, void*, size_t)>("read");
  return fails(read_call, file) ? -1 : real(file, bytes, size);
}

ssize_t pread(int file, void* bytes, size_t size, off_t offset) {
  static auto* const real = next<ssize_t(int, void*, size_t, off_t)>("pread");
  return fails(read_call, file) ? -1 : real(file, bytes, size, offset);
}

ssize_t pread64(int file, void* bytes, size_t size, off64_t offset) {
  return ::pread(file, bytes, size, offset);
}

ssize_t readv(int file, const iovec* parts, int count) {
  static auto* const real = next<ssize_t(int, const iovec*, int)>("readv");
  return fails(read_call, file) ? -1 : real(file, parts, count);
}

int clock_gettime(clockid_t clock, timespec* time) noexcept {
  static auto* const real = next<int(clockid_t, timespec*)>("clock_gettime");
  const int status = real(clock, time);
  if (status == 0 && (clock == CLOCK_REALTIME || clock == CLOCK_REALTIME_COARSE) &&
      faults() != nullptr) {
    time->tv_sec += faults()->clock_seconds;
  }
  return status;
}

int statvfs(const char* path, struct statvfs* found) noexcept {
  static auto* const real = next<int(const char*, struct statvfs*)>("statvfs");
  const int status = real(path, found);
  if (status == 0 && faults() != nullptr && faults()->disk_bytes > 0 && is_ours(path)) {
    found->f_bavail = free_of(faults()->disk_bytes) / found->f_frsize;
    found->f_bfree = found->f_bavail;
  }
  return status;
}

int statvfs64(const char* path, struct statvfs64* found) noexcept {
  return ::statvfs(path, reinterpret_cast<struct statvfs*>(found));  // they are the same here
}

time_t time(time_t* seconds) noexcept {
  timespec now{};
  ::clock_gettime(CLOCK_REALTIME, &now);
  if (seconds != nullptr) {
    *seconds = now.tv_sec;
  }
  return now.tv_sec;
}

int gettimeofday(timeval* now, void* /*zone*/) noexcept {
  timespec time{};
  ::clock_gettime(CLOCK_REALTIME, &time);
  *now = {.tv_sec = time.tv_sec, .tv_usec = time.tv_nsec / 1000};
  return 0;
}

}  // extern "C"
// NOLINTEND(readability-identifier-naming)
