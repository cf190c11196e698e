#include "store/json_numbers.hpp"

#include <cmath>
#include <nlohmann/json.hpp>

namespace octurn {

double to_thousandths(double value) { return std::round(value * 1000) / 1000; }

double number_or_zero(JsonObject& keys, std::string_view key, double max) {
  const auto value = keys.value(key);
  return !value || value->json().is_null() ? 0 : value->number(0, max);
}

}  // namespace octurn
