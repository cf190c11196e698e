#include "io/number_text.hpp"

#include <array>
#include <cmath>
#include <cstdio>

#include "octurn/units.hpp"

namespace octurn {
namespace {

std::string fixed_text(double value, int digits) {
  const std::string format = "%." + std::to_string(digits) + "f";
  return number_text(format.c_str(), value);
}

}  // namespace

std::string number_text(const char* format, double value) {
  std::array<char, 96> text{};
  std::snprintf(text.data(), text.size(), format, value);
  return text.data();
}

std::string mm_text(double metres, int digits) {
  return fixed_text(mm_from_metres(metres), digits) + " mm";
}

std::string mm_text(double metres) {
  std::string text = fixed_text(mm_from_metres(metres), 6);
  text.erase(text.find_last_not_of('0') + 1);
  if (text.back() == '.') {
    text.pop_back();
  }
  return text + " mm";
}

std::string degrees_text(double radians, int digits) {
  return fixed_text(degrees_from_radians(radians), digits) + " degrees";
}

std::string percent_text(double share) { return fixed_text(100 * share, 0) + " %"; }

std::string mb_text(std::size_t bytes) { return fixed_text(rounded_up_mb(bytes), 0) + " MB"; }

double rounded_up_mb(std::size_t bytes) {
  return std::ceil(mb_from_bytes(static_cast<double>(bytes)));
}

}  // namespace octurn
