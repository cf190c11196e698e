#include "json_object.hpp"

#include <cmath>
#include <nlohmann/json.hpp>
#include <sstream>
#include <utility>

#include "octurn/error.hpp"

namespace octurn {
namespace {

using nlohmann::json;

constexpr std::size_t longest_quote = 60;  // of a value in a message, characters

std::string shown(const json& value) {
  std::string text = value.dump(-1, ' ', true, json::error_handler_t::replace);
  if (text.size() > longest_quote) {
    text.resize(longest_quote);
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
  return json(dotted).dump(-1, ' ', true, json::error_handler_t::replace);
}

json parse_json(std::string_view text, const std::string& code, const std::string& what) {
  json document = json::parse(text, nullptr, false);
  if (document.is_discarded()) {
    throw Error(code, what + " is not JSON");
  }
  return document;
}

}  // namespace octurn
