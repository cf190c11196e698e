#pragma once

#include <cstddef>
#include <string>

namespace octurn {

/// Numbers in messages for people.

/// @param format  of printf, for one double; the text has up to 95 characters
std::string number_text(const char* format, double value);

/// With a fixed number of decimals: "0.25 mm".
std::string mm_text(double metres, int digits);

/// With as many decimals as needed, at most six: "0.25 mm".
std::string mm_text(double metres);

/// With a fixed number of decimals: "1.5 degrees".
std::string degrees_text(double radians, int digits);

/// Rounded to an integer: "25 %".
std::string percent_text(double share);

/// Rounded up to an integer, so that the memory limit that a message names is enough: "36 MB".
std::string mb_text(std::size_t bytes);

/// The number of `mb_text`.
double rounded_up_mb(std::size_t bytes);

}  // namespace octurn
