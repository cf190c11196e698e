#include "store/failure_json.hpp"

#include <nlohmann/json.hpp>

#include "store/parameters_json.hpp"

namespace octurn {

nlohmann::json to_json(const Failure& failure) {
  nlohmann::json object{
      {"code", to_string(failure.code)}, {"detail", failure.detail}, {"hint", failure.hint}};
  if (!failure.parameters.empty()) {
    object["parameters"] = to_json(failure.parameters);
  }
  return object;
}

Failure to_failure(const JsonValue& object) {
  JsonObject keys(object);
  return {.code = to_error_code(keys.at("code").text()).value_or(ErrorCode::unknown),
          .detail = keys.at("detail").text(),
          .hint = keys.at("hint").text(),
          .parameters = to_parameters(keys.value("parameters"))};
}

}  // namespace octurn
