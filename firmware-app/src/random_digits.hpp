#pragma once

#include <cstddef>
#include <string>

namespace octurn {

/// Secrets and names that nobody can guess: random bytes of the system's, as two hexadecimal digits
/// each.
/// @param bytes  at most 256
/// @throws Error  internal, if the system has none
std::string random_digits(std::size_t bytes);

}  // namespace octurn
