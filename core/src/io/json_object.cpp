#include "octurn/json_object.hpp"

#include <cmath>
#include <nlohmann/json.hpp>
#include <sstream>
#include <utility>

#include "octurn/error.hpp"

namespace octurn {
namespace {

using nlohmann::json;

constexpr std::size_t max_quote = 60;  // characters of a value in a message

std::string plain(double number) {
  std::ostringstream text;
  text.precision(10);  // 1767225600, not 1.76723e+09
  text << number;
  return text.str();
}

std::string ascii(const json& value) {
  if (value.is_number_float() && !std::isfinite(value.get<double>())) {
    return plain(value.get<double>());  // from the command line: JSON has no NaN or infinity
  }
  return value.dump(-1, ' ', true, json::error_handler_t::replace);
}

/// A scalar in full, an array or object as its brackets. Does not recurse: the value may be deep.
std::string outlined(const json& value) {
  if (!value.is_structured() || value.empty()) {
    return ascii(value);
  }
  return value.is_array() ? "[...]" : "{...}";
}

/// The first elements of an array or object, outlined.
std::string first_elements(const json& value) {
  std::string text;
  for (const auto& [key, element] : value.items()) {
    text += text.empty() ? "" : ",";
    text += (value.is_object() ? ascii(key) + ":" : "") + outlined(element);
    if (text.size() > max_quote) {
      break;
    }
  }
  return value.is_array() ? "[" + text + "]" : "{" + text + "}";
}

/// The beginning of a value, for messages.
std::string shown(const json& value) {
  std::string text = value.is_structured() ? first_elements(value) : ascii(value);
  if (text.size() > max_quote) {
    text.resize(max_quote);
    text += "...";
  }
  return text;
}

std::string quoted(const std::string& name) { return name.empty() ? "it" : ascii(name); }

std::string refusal(const JsonValue& value, const std::string& must) {
  return quoted(value.name()) + " is " + shown(value.json()) + ": must be " + must;
}

[[noreturn]] void refuse_range(const JsonValue& value, const std::string& must, double min,
                               double max) {
  throw Error(value.code(), refusal(value, must), "",
              {{"key", value.name()}, {"minimum", min}, {"maximum", max}});
}

}  // namespace

JsonValue::JsonValue(const nlohmann::json& value, std::string name, ErrorCode code)
    : value_(value), name_(std::move(name)), code_(code) {}

double JsonValue::number() const {
  if (!value_.is_number()) {
    refuse("a number");
  }
  return value_.get<double>();
}

double JsonValue::number(double min, double max) const {
  // Written so that NaN is refused.
  if (!value_.is_number() || !(value_.get<double>() >= min && value_.get<double>() <= max)) {
    refuse_range(*this, "a number from " + plain(min) + " to " + plain(max), min, max);
  }
  return value_.get<double>();
}

int JsonValue::whole_number(int min, int max) const {
  if (!value_.is_number_integer() || value_.get<double>() < min || value_.get<double>() > max) {
    refuse_range(*this, "a whole number from " + std::to_string(min) + " to " + std::to_string(max),
                 min, max);
  }
  return value_.get<int>();
}

bool JsonValue::flag() const {
  if (!value_.is_boolean()) {
    refuse("true or false");
  }
  return value_.get<bool>();
}

std::string JsonValue::text() const {
  if (!value_.is_string()) {
    refuse("text");
  }
  return value_.get<std::string>();
}

std::vector<JsonValue> JsonValue::elements() const {
  if (!value_.is_array()) {
    refuse("an array");
  }
  std::vector<JsonValue> elements;
  for (std::size_t i = 0; i < value_.size(); ++i) {
    elements.emplace_back(value_[i], name_ + "[" + std::to_string(i) + "]", code_);
  }
  return elements;
}

std::vector<JsonValue> JsonValue::elements(std::size_t count) const {
  if (!value_.is_array() || value_.size() != count) {
    refuse("an array of " + std::to_string(count));
  }
  return elements();
}

void JsonValue::refuse(const std::string& must) const { throw Error(code_, refusal(*this, must)); }

JsonObject::JsonObject(JsonValue object) : object_(std::move(object)) {
  if (!object_.json().is_object()) {
    object_.refuse("an object");
  }
}

JsonObject::JsonObject(const nlohmann::json& object, ErrorCode code, std::string name)
    : JsonObject(JsonValue(object, std::move(name), code)) {}

JsonValue JsonObject::at(std::string_view key) {
  std::optional<JsonValue> found = value(key);
  if (!found) {
    throw Error(object_.code(), quoted(path_to(key)) + " is missing");
  }
  return *std::move(found);
}

std::optional<JsonValue> JsonObject::value(std::string_view key) {
  const nlohmann::json* found = find(key);
  return found == nullptr ? std::nullopt
                          : std::optional(JsonValue(*found, path_to(key), object_.code()));
}

std::optional<double> JsonObject::number(std::string_view key, double min, double max) {
  const auto found = value(key);
  return found ? std::optional(found->number(min, max)) : std::nullopt;
}

std::optional<int> JsonObject::whole_number(std::string_view key, int min, int max) {
  const auto found = value(key);
  return found ? std::optional(found->whole_number(min, max)) : std::nullopt;
}

std::optional<bool> JsonObject::flag(std::string_view key) {
  const auto found = value(key);
  return found ? std::optional(found->flag()) : std::nullopt;
}

std::optional<std::string> JsonObject::text(std::string_view key) {
  const auto found = value(key);
  return found ? std::optional(found->text()) : std::nullopt;
}

const nlohmann::json* JsonObject::find(std::string_view key) {
  read_.emplace(key);
  const auto found = object_.json().find(key);
  return found == object_.json().end() ? nullptr : &*found;
}

void JsonObject::refuse_unread() const {
  for (const auto& [key, value] : object_.json().items()) {
    if (!read_.contains(key)) {
      std::string known;
      for (const std::string& name : read_) {
        known += (known.empty() ? "" : ", ") + name;
      }
      throw Error(object_.code(), quoted(path_to(key)) + ": unknown key",
                  "The keys are: " + known + ".");
    }
  }
}

void JsonObject::refuse(std::string_view key, const nlohmann::json& value,
                        const std::string& must) const {
  JsonValue(value, path_to(key), object_.code()).refuse(must);
}

std::string JsonObject::path_to(std::string_view key) const {
  return object_.name().empty() ? std::string(key) : object_.name() + "." + std::string(key);
}

json parse_json(std::string_view text, ErrorCode code, const std::string& what,
                const JsonLimits& limits) {
  if (text.size() > limits.bytes) {
    throw Error(code, what + " has " + std::to_string(text.size()) + " bytes: must have at most " +
                          std::to_string(limits.bytes));
  }
  std::size_t values = 0;
  const auto expect_small = [&](int depth, json::parse_event_t event, const json& /*value*/) {
    const bool opens =
        event == json::parse_event_t::object_start || event == json::parse_event_t::array_start;
    if (opens && depth >= max_json_depth) {
      throw Error(code, what + " is nested more than " + std::to_string(max_json_depth) + " deep");
    }
    if ((opens || event == json::parse_event_t::value) && ++values > limits.values) {
      throw Error(code, what + " has more than " + std::to_string(limits.values) + " values");
    }
    return true;
  };
  json document = json::parse(text, expect_small, false);
  if (document.is_discarded()) {
    throw Error(code, what + " is not JSON");
  }
  return document;
}

bool is_utf8(const std::string& text) {
  try {
    static_cast<void>(json(text).dump());  // throws at any other text
    return true;
  } catch (const json::type_error&) {
    return false;
  }
}

}  // namespace octurn
