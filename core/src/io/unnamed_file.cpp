#include "io/unnamed_file.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <string>
#include <system_error>

#include "octurn/error.hpp"

namespace octurn {
namespace {

[[noreturn]] void fail(const std::string& doing, int number) {
  const bool full = number == ENOSPC || number == EDQUOT || number == EFBIG;
  throw Error(full ? ErrorCode::disk_full : ErrorCode::write_failed,
              "cannot " + doing + ": " + std::generic_category().message(number),
              full ? "Delete scans that are no longer needed, or use a larger disk." : "");
}

/// Opens an unnamed file. Where the file system does not support O_TMPFILE, a named one is unlinked
/// at once.
int open_unnamed(const std::filesystem::path& folder) {
  const int descriptor = ::open(folder.c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC, 0600);
  if (descriptor >= 0) {
    return descriptor;
  }
  std::string name = folder / ".octurn-XXXXXX";
  const int named = ::mkostemp(name.data(), O_CLOEXEC);
  if (named >= 0) {
    ::unlink(name.c_str());
  }
  return named;
}

}  // namespace

UnnamedFile::UnnamedFile(const std::filesystem::path& folder) : descriptor_(open_unnamed(folder)) {
  if (descriptor_ < 0) {
    fail("make a temporary file in " + folder.string(), errno);
  }
}

UnnamedFile::~UnnamedFile() { ::close(descriptor_); }

void UnnamedFile::append(std::span<const std::byte> bytes) {
  while (!bytes.empty()) {
    const ssize_t written =
        ::pwrite(descriptor_, bytes.data(), bytes.size(), static_cast<off_t>(size_));
    if (written < 0 && errno == EINTR) {
      continue;
    }
    if (written <= 0) {
      fail("write to a temporary file", written < 0 ? errno : ENOSPC);
    }
    size_ += static_cast<std::uint64_t>(written);
    bytes = bytes.subspan(static_cast<std::size_t>(written));
  }
}

void UnnamedFile::read(std::uint64_t offset, std::span<std::byte> bytes) const {
  while (!bytes.empty()) {
    const ssize_t got =
        ::pread(descriptor_, bytes.data(), bytes.size(), static_cast<off_t>(offset));
    if (got < 0 && errno == EINTR) {
      continue;
    }
    if (got <= 0) {
      throw Error(ErrorCode::read_failed, "cannot read a temporary file back");
    }
    offset += static_cast<std::uint64_t>(got);
    bytes = bytes.subspan(static_cast<std::size_t>(got));
  }
}

}  // namespace octurn
