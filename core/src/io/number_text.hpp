#pragma once

#include <cstddef>
#include <string>

namespace octurn {

/// Numbers in messages for people.

/// @param format  of printf, for one double; the text has up to 95 characters
std::string number_text(const char* format, double value);

/// With so many digits after the point: "0.25 mm".
std::string mm_text(double metres, int digits);

/// With the digits that it needs, at most six after the point: "0.25 mm".
std::string mm_text(double metres);

/// With so many digits after the point: "1.5 degrees".
std::string degrees_text(double radians, int digits);

/// Whole: "25 %".
std::string percent_text(double share);

/// Whole, rounded up, so that the memory limit that a message names is enough: "36 MB".
std::string mb_text(std::size_t bytes);

/// The same as a number.
double rounded_up_mb(std::size_t bytes);

}  // namespace octurn
