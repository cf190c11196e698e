#pragma once

#include <stdexcept>
#include <string>
#include <utility>

namespace octurn {

/// What went wrong outside this program: a file, a device, a disk, a setting.
///
/// `what()` is one line with the values in it; `code()` is a stable word for programs, such as
/// "scan-malformed" or "disk-full"; `hint()` says what a person can do about it, or is empty.
class Error : public std::runtime_error {
 public:
  explicit Error(std::string code, const std::string& message, std::string hint = {})
      : std::runtime_error(message), code_(std::move(code)), hint_(std::move(hint)) {}

  const std::string& code() const { return code_; }
  const std::string& hint() const { return hint_; }

 private:
  std::string code_;
  std::string hint_;
};

}  // namespace octurn
