#include "host_name.hpp"

#include <unistd.h>

#include <array>

namespace octurn {

std::string host_name() {
  std::array<char, 65> name{};  // HOST_NAME_MAX and the terminating NUL
  ::gethostname(name.data(), name.size() - 1);
  return name.data();
}

}  // namespace octurn
