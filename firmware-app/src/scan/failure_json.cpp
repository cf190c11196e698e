#include "scan/failure_json.hpp"

#include <nlohmann/json.hpp>

namespace octurn {

nlohmann::json to_json(const Failure& failure) {
  return {{"code", to_string(failure.code)}, {"detail", failure.detail}, {"hint", failure.hint}};
}

Failure to_failure(const JsonValue& object) {
  JsonObject keys(object);
  return {.code = to_error_code(keys.at("code").text()).value_or(ErrorCode::unknown),
          .detail = keys.at("detail").text(),
          .hint = keys.at("hint").text()};
}

}  // namespace octurn
