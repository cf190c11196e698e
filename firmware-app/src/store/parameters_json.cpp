#include "store/parameters_json.hpp"

#include <nlohmann/json.hpp>
#include <variant>

namespace octurn {

nlohmann::json to_json(const Parameters& parameters) {
  nlohmann::json object = nlohmann::json::object();
  for (const auto& [name, value] : parameters) {
    std::visit([&object, &name = name](const auto& plain) { object[name] = plain; }, value);
  }
  return object;
}

Parameters to_parameters(const std::optional<JsonValue>& object) {
  Parameters parameters;
  if (!object) {
    return parameters;
  }
  if (!object->json().is_object()) {
    object->refuse("an object");
  }
  for (const auto& [name, json] : object->json().items()) {
    const JsonValue value(json, object->name() + "." + name, object->code());
    if (json.is_string()) {
      parameters.emplace(name, value.text());
    } else {
      parameters.emplace(name, value.number());
    }
  }
  return parameters;
}

}  // namespace octurn
