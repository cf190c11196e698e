#pragma once

#include <limits>
#include <string_view>

#include "octurn/json_object.hpp"

namespace octurn {

/// The limit of numbers that have none.
inline constexpr double unlimited = std::numeric_limits<double>::max();

/// Rounds to three decimals, the precision of seconds, millimetres and fractions in JSON.
double to_thousandths(double value);

/// Reads the number of an optional key, from 0 to `max`; 0 if it is missing or null.
/// @throws Error  if it is not a number, or out of range
double number_or_zero(JsonObject& keys, std::string_view key, double max);

}  // namespace octurn
