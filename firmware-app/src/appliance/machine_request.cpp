#include "appliance/machine_request.hpp"

#include <algorithm>
#include <cctype>
#include <cstddef>
#include <nlohmann/json.hpp>
#include <string_view>

#include "octurn/json_object.hpp"

namespace octurn {
namespace {

constexpr std::size_t max_host_name = 63;  // bytes of a label: RFC 1035, 2.3.4
constexpr std::size_t max_zone_name = 64;

bool is_host_character(char c) {
  return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '-';
}

bool is_zone_character(char c) {
  return std::isalnum(static_cast<unsigned char>(c)) != 0 ||
         std::string_view("_+/-").find(c) != std::string_view::npos;
}

/// @throws Error "bad-settings"  if the value is not a valid host name
std::string to_host_name(const JsonValue& value) {
  std::string name = value.text();
  std::ranges::transform(name, name.begin(),
                         [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (name.empty() || name.size() > max_host_name || name.starts_with('-') || name.ends_with('-') ||
      !std::ranges::all_of(name, is_host_character)) {
    value.refuse("letters, digits and hyphens between them, at most 63");
  }
  return name;
}

/// Checks the characters of a zone's name. Root checks whether the zone exists.
std::string to_zone(const JsonValue& value) {
  std::string zone = value.text();
  if (zone.empty() || zone.size() > max_zone_name ||
      !std::ranges::all_of(zone, is_zone_character)) {
    value.refuse("a continent and a city, such as Europe/Berlin");
  }
  return zone;
}

}  // namespace

MachineRequest machine_request_from(const nlohmann::json& body) {
  JsonObject keys(body, ErrorCode::bad_settings, "");
  MachineRequest request;
  if (const auto name = keys.value("name")) {
    request.name = to_host_name(*name);
  }
  if (const auto zone = keys.value("time_zone")) {
    request.time_zone = to_zone(*zone);
  }
  keys.refuse_unread();
  if (!request.name && !request.time_zone) {
    throw Error(ErrorCode::bad_settings, "the body has neither name nor time_zone");
  }
  return request;
}

std::string to_text(const MachineRequest& request) {
  return (request.name ? "name = " + *request.name + "\n" : "") +
         (request.time_zone ? "time_zone = " + *request.time_zone + "\n" : "");
}

}  // namespace octurn
