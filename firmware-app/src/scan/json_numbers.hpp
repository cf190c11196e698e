#pragma once

#include <string_view>

#include "octurn/json_object.hpp"

namespace octurn {

/// Rounds to thousandths, as JSON has seconds, millimetres and shares.
double to_thousandths(double value);

/// The number of an optional key, from 0 to `max`; 0 if it is missing or null.
/// @throws Error  if it is of another kind or out of range
double number_or_zero(JsonObject& keys, std::string_view key, double max);

}  // namespace octurn
