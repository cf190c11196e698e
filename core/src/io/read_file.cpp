#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <system_error>

#include "octurn/error.hpp"
#include "octurn/file.hpp"

namespace octurn {
namespace {

constexpr std::size_t read_block_bytes = std::size_t{1} << 16U;

[[noreturn]] void fail(const std::filesystem::path& file, const std::string& reason) {
  throw Error(ErrorCode::read_failed, file.string() + ": cannot be read: " + reason,
              "Check that this program may read it, and that the disk is sound.");
}

/// An open file descriptor, closed by the destructor.
class OpenFile {
 public:
  explicit OpenFile(const std::filesystem::path& file)
      : number_(::open(file.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC)) {}
  ~OpenFile() {
    if (number_ >= 0) {
      ::close(number_);
    }
  }
  OpenFile(const OpenFile&) = delete;
  OpenFile& operator=(const OpenFile&) = delete;

  int number() const { return number_; }

 private:
  int number_;
};

}  // namespace

std::optional<std::string> read_regular_file(const std::filesystem::path& file,
                                             std::size_t max_bytes) {
  const OpenFile open(file);
  if (open.number() < 0) {
    if (errno == ENOENT) {
      return std::nullopt;
    }
    fail(file, std::generic_category().message(errno));
  }
  struct stat status = {};
  if (::fstat(open.number(), &status) != 0) {
    fail(file, std::generic_category().message(errno));
  }
  if (!S_ISREG(status.st_mode)) {
    fail(file, "not a regular file");
  }
  std::string content;
  for (;;) {
    const std::size_t had = content.size();
    content.resize(had + std::min(read_block_bytes, max_bytes + 1 - had));
    const ssize_t got = ::read(open.number(), content.data() + had, content.size() - had);
    if (got < 0 && errno != EINTR) {
      fail(file, std::generic_category().message(errno));
    }
    content.resize(had + static_cast<std::size_t>(std::max<ssize_t>(got, 0)));
    if (got == 0) {
      return content;
    }
    if (content.size() > max_bytes) {
      throw Error(ErrorCode::file_too_large,
                  file.string() + ": larger than " + std::to_string(max_bytes) + " bytes",
                  "Such files are far smaller; check what wrote it.");
    }
  }
}

}  // namespace octurn
