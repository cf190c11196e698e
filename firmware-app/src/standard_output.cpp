#include "standard_output.hpp"

#include <unistd.h>

#include <cerrno>
#include <system_error>

#include "octurn/error.hpp"

namespace octurn {

void write_standard_output(std::span<const std::byte> bytes) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(STDOUT_FILENO, bytes.data(), bytes.size());
    if (written < 0 && errno != EINTR) {
      throw Error(ErrorCode::write_failed,
                  "standard output: cannot write: " + std::generic_category().message(errno));
    }
    bytes = bytes.subspan(static_cast<std::size_t>(written < 0 ? 0 : written));
  }
}

void write_standard_output(std::string_view text) {
  write_standard_output(std::as_bytes(std::span(text)));
}

}  // namespace octurn
