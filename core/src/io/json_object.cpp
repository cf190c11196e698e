#include "octurn/json_object.hpp"

#include <cmath>
#include <nlohmann/json.hpp>
#include <sstream>
#include <utility>

#include "octurn/error.hpp"

namespace octurn {
namespace {

using nlohmann::json;

constexpr std::size_t max_quote = 60;  // of a value in a message, characters

std::string ascii(const json& value) {
  return value.dump(-1, ' ', true, json::error_handler_t::replace);
}

/// A scalar as it is, an array or object by its brackets: never recurses.
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

std::string plain(double number) {
  std::ostringstream text;
  text << number;
  return text.str();
}

}  // namespace

JsonObject::JsonObject(const json& object, std::string code, std::string name)
    : object_(object), code_(std::move(code)), name_(std::move(name)) {
  if (!object_.is_object()) {
    throw Error(code_, (name_.empty() ? "it" : "\"" + name_ + "\"") + " is " + shown(object_) +
                           ": must be an object");
  }
}

const json* JsonObject::find(std::string_view key) {
  read_.emplace(key);
  const auto found = object_.find(key);
  return found == object_.end() ? nullptr : &*found;
}

std::optional<double> JsonObject::number(std::string_view key, double least, double most) {
  const json* value = find(key);
  if (value == nullptr) {
    return std::nullopt;
  }
  // Written so that a number that is none fails.
  if (!value->is_number() || !(value->get<double>() >= least && value->get<double>() <= most)) {
    refuse(key, *value, "a number from " + plain(least) + " to " + plain(most));
  }
  return value->get<double>();
}

std::optional<int> JsonObject::whole_number(std::string_view key, int least, int most) {
  const json* value = find(key);
  if (value == nullptr) {
    return std::nullopt;
  }
  if (!value->is_number_integer() || value->get<double>() < least || value->get<double>() > most) {
    refuse(key, *value,
           "a whole number from " + std::to_string(least) + " to " + std::to_string(most));
  }
  return value->get<int>();
}

std::optional<bool> JsonObject::flag(std::string_view key) {
  const json* value = find(key);
  if (value == nullptr) {
    return std::nullopt;
  }
  if (!value->is_boolean()) {
    refuse(key, *value, "true or false");
  }
  return value->get<bool>();
}

std::optional<std::string> JsonObject::text(std::string_view key) {
  const json* value = find(key);
  if (value == nullptr) {
    return std::nullopt;
  }
  if (!value->is_string()) {
    refuse(key, *value, "text");
  }
  return value->get<std::string>();
}

void JsonObject::refuse_unread() const {
  for (const auto& [key, value] : object_.items()) {
    if (!read_.contains(key)) {
      std::string known;
      for (const std::string& name : read_) {
        known += (known.empty() ? "" : ", ") + name;
      }
      throw Error(code_, quoted(key) + ": unknown key", "The keys are: " + known + ".");
    }
  }
}

void JsonObject::refuse(std::string_view key, const json& value, const std::string& must) const {
  throw Error(code_, quoted(key) + " is " + shown(value) + ": must be " + must);
}

std::string JsonObject::quoted(std::string_view key) const {
  const std::string dotted = name_.empty() ? std::string(key) : name_ + "." + std::string(key);
  return ascii(dotted);
}

json parse_json(std::string_view text, const std::string& code, const std::string& what) {
  if (text.size() > max_json_bytes) {
    throw Error(code, what + " has " + std::to_string(text.size()) + " bytes: must have at most " +
                          std::to_string(max_json_bytes));
  }
  const auto expect_shallow = [&](int depth, json::parse_event_t event, const json& /*value*/) {
    const bool opens =
        event == json::parse_event_t::object_start || event == json::parse_event_t::array_start;
    if (opens && depth >= max_json_depth) {
      throw Error(code, what + " is nested more than " + std::to_string(max_json_depth) + " deep");
    }
    return true;
  };
  json document = json::parse(text, expect_shallow, false);
  if (document.is_discarded()) {
    throw Error(code, what + " is not JSON");
  }
  return document;
}

}  // namespace octurn
