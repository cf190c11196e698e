#include "appliance/wifi_request.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "octurn/error.hpp"
#include "octurn/json_object.hpp"
#include "one_line.hpp"

namespace octurn {
namespace {

using nlohmann::json;

constexpr std::size_t max_wifi_name = 32;                // bytes: IEEE 802.11-2020, 9.4.2.2
constexpr std::size_t min_password = 8;                  // characters: IEEE 802.11-2020, annex J.4
constexpr std::size_t max_password = 63;                 // as above
constexpr std::size_t digits_of_key = 64;                // hexadecimal digits of a 256-bit key
constexpr std::string_view known_password = "********";  // octurn.txt: a stored password

bool is_printable_ascii(char c) { return c >= ' ' && c <= '~'; }
bool is_letter(char c) { return (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z'); }
bool is_hexadecimal(char c) {
  return (c >= '0' && c <= '9') || (c >= 'A' && c <= 'F') || (c >= 'a' && c <= 'f');
}
bool has_blanks_around(std::string_view text) {
  return text.starts_with(' ') || text.ends_with(' ');
}

std::string name_in(JsonObject& keys) {
  const auto name = keys.text("name");
  if (!name || !is_wifi_name(*name)) {
    throw Error(ErrorCode::bad_wifi,
                "\"name\" must be text of 1 to 32 bytes on one line, without blanks around it",
                "It is the name of the WiFi as others see it.");
  }
  return *name;
}

std::optional<std::string> password_in(JsonObject& keys) {
  const json* const value = keys.find("password");
  if (value == nullptr) {
    return std::nullopt;
  }
  const std::string password = value->is_string() ? value->get<std::string>() : "";
  const bool is_key =
      password.size() == digits_of_key && std::ranges::all_of(password, is_hexadecimal);
  const bool is_passphrase = password.size() >= min_password && password.size() <= max_password &&
                             std::ranges::all_of(password, is_printable_ascii);
  if (!is_key && !is_passphrase) {
    throw Error(ErrorCode::bad_wifi,
                "\"password\" must be text of 8 to 63 letters, digits and signs without accents",
                "Look for typing errors; leave it out if the WiFi is open.");
  }
  if (has_blanks_around(password)) {
    throw Error(ErrorCode::bad_wifi, "\"password\" has a blank at its begin or its end",
                "Octurn cannot keep it so: give the WiFi another password.");
  }
  if (password == known_password) {
    throw Error(ErrorCode::bad_wifi,
                "\"password\" is eight stars, which stand for one that is not shown",
                "Write the password itself.");
  }
  return password;
}

std::string country_in(JsonObject& keys) {
  std::string country = keys.text("country").value_or("");
  if (country.size() != 2 || !std::ranges::all_of(country, is_letter)) {
    throw Error(ErrorCode::bad_wifi, "\"country\" must be two letters, such as DE",
                "It tells which channels are allowed where the scanner is.");
  }
  const auto capital = [](char c) { return c >= 'a' ? static_cast<char>(c - 32) : c; };
  std::ranges::transform(country, country.begin(), capital);
  return country;
}

}  // namespace

bool is_wifi_name(std::string_view name) {
  return !name.empty() && name.size() <= max_wifi_name && is_one_line(name) &&
         !has_blanks_around(name);
}

WifiRequest wifi_request_from(const json& body) {
  JsonObject keys(body, ErrorCode::bad_wifi, "");
  WifiRequest request{
      .name = name_in(keys), .password = password_in(keys), .country = country_in(keys)};
  keys.refuse_unread();
  return request;
}

std::string to_text(const WifiRequest& request) {
  std::string text = "wifi_name = " + request.name + "\n";
  if (request.password) {
    text += "wifi_password = " + *request.password + "\n";
  }
  return text + "wifi_country = " + request.country + "\n";
}

}  // namespace octurn
