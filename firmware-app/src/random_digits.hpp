#pragma once

#include <cstddef>
#include <string>

namespace octurn {

/// Bytes of a secret: 128 bits are beyond any number of guesses.
inline constexpr std::size_t secret_bytes = 16;

/// Returns random bytes from getentropy(3) as two hexadecimal digits each, for secrets and names
/// that nobody can guess.
/// @param bytes  at most 256
/// @throws Error "internal"  if getentropy fails
std::string random_digits(std::size_t bytes);

}  // namespace octurn
