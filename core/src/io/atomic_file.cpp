#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <new>
#include <string>
#include <system_error>
#include <utility>

#include "octurn/error.hpp"
#include "octurn/file.hpp"

namespace octurn {
namespace {

constexpr std::size_t write_block_bytes = std::size_t{1} << 20U;
constexpr std::size_t page_bytes = 4096;  // direct writes need memory aligned to pages

[[noreturn]] void fail(const std::filesystem::path& file, const char* doing, int number) {
  const std::string reason = std::generic_category().message(number);
  const bool full = number == ENOSPC || number == EDQUOT || number == EFBIG;
  throw Error(full ? ErrorCode::disk_full : ErrorCode::write_failed,
              file.string() + ": cannot " + doing + ": " + reason,
              full ? "Delete scans that are no longer needed, or use a larger disk."
                   : "Check that the folder exists and that this program may write to it.",
              {{"path", file.string()}});
}

std::filesystem::path parent_folder(const std::filesystem::path& file) {
  return file.has_parent_path() ? file.parent_path() : std::filesystem::path(".");
}

}  // namespace

void sync_folder(const std::filesystem::path& folder) {
  const int descriptor = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor < 0) {
    fail(folder, "sync", errno);
  }
  const int number = ::fsync(descriptor) == 0 ? 0 : errno;
  ::close(descriptor);
  if (number != 0 && number != EINVAL) {  // some file systems have nothing to sync in a folder
    fail(folder, "sync", number);
  }
}

std::filesystem::path temporary_name(const std::filesystem::path& target, int attempt) {
  std::string name(1, '.');
  name +=
      target.filename().string() + '.' + std::to_string(::getpid()) + '-' + std::to_string(attempt);
  return parent_folder(target) / name;
}

AtomicFile::AtomicFile(std::filesystem::path target, unsigned permissions)
    : target_(std::move(target)),
      block_(static_cast<std::byte*>(std::aligned_alloc(page_bytes, write_block_bytes)),
             &std::free) {
  if (!block_) {
    throw std::bad_alloc();
  }
  std::error_code unknown;  // opening the file says why
  const std::filesystem::file_status status = std::filesystem::status(target_, unknown);
  if (std::filesystem::exists(status) && !std::filesystem::is_regular_file(status)) {
    throw Error(ErrorCode::write_failed, target_.string() + ": cannot write: not a regular file",
                "Name a file that does not exist yet, or one that may be replaced.");
  }
  for (int attempt = 0; descriptor_ < 0; ++attempt) {
    temporary_ = temporary_name(target_, attempt);
    descriptor_ = ::open(temporary_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, permissions);
    if (descriptor_ < 0 && errno != EEXIST) {
      fail(target_, "write", errno);
    }
  }
}

AtomicFile::~AtomicFile() {
  if (descriptor_ >= 0) {
    ::close(descriptor_);
    ::unlink(temporary_.c_str());
  }
}

void AtomicFile::write(std::span<const std::byte> bytes) {
  while (!bytes.empty()) {
    const auto part = bytes.first(std::min(bytes.size(), write_block_bytes - filled_));
    std::ranges::copy(part, block_.get() + filled_);
    filled_ += part.size();
    bytes = bytes.subspan(part.size());
    if (filled_ == write_block_bytes) {
      if (written_ == 0) {
        set_direct(true);
      }
      flush();
    }
  }
}

void AtomicFile::write_at(std::uint64_t offset, std::span<const std::byte> bytes) {
  set_direct(false);
  flush();
  put(offset, bytes);
}

void AtomicFile::flush() {
  put(written_, {block_.get(), filled_});
  written_ += std::exchange(filled_, 0);
}

void AtomicFile::put(std::uint64_t offset, std::span<const std::byte> bytes) {
  while (!bytes.empty()) {
    const ssize_t done =
        ::pwrite(descriptor_, bytes.data(), bytes.size(), static_cast<off_t>(offset));
    if (done > 0) {
      offset += static_cast<std::size_t>(done);
      bytes = bytes.subspan(static_cast<std::size_t>(done));
    } else if (const int number = done < 0 ? errno : ENOSPC;
               number != EINTR && !(number == EINVAL && set_direct(false))) {
      fail(target_, "write", number);
    }
  }
}

/// Sets or clears O_DIRECT, with which writes bypass the page cache.
/// @return whether it changed; some file systems do not support it
bool AtomicFile::set_direct(bool direct) {
  const int flags = ::fcntl(descriptor_, F_GETFL);
  const int wanted = direct ? flags | O_DIRECT : flags & ~O_DIRECT;
  return flags >= 0 && wanted != flags && ::fcntl(descriptor_, F_SETFL, wanted) == 0;
}

void AtomicFile::commit() {
  set_direct(false);
  flush();
  if (::fsync(descriptor_) != 0) {
    fail(target_, "sync", errno);
  }
  if (::rename(temporary_.c_str(), target_.c_str()) != 0) {
    fail(target_, "put in place", errno);
  }
  ::close(std::exchange(descriptor_, -1));
  sync_folder(parent_folder(target_));
}

void write_file(const std::filesystem::path& target, std::string_view content,
                unsigned permissions) {
  AtomicFile file(target, permissions);
  file.write(std::as_bytes(std::span(content)));
  file.commit();
}

}  // namespace octurn
