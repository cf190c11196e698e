#include "random_digits.hpp"

#include <unistd.h>

#include <string_view>
#include <vector>

#include "octurn/error.hpp"

namespace octurn {

std::string random_digits(std::size_t bytes) {
  std::vector<unsigned char> drawn(bytes);
  if (::getentropy(drawn.data(), bytes) != 0) {
    throw Error(ErrorCode::internal, "the system has no random numbers");
  }
  constexpr std::string_view digits = "0123456789abcdef";
  std::string text;
  for (const unsigned char byte : drawn) {
    text += digits[byte >> 4U];
    text += digits[byte & 15U];
  }
  return text;
}

}  // namespace octurn
