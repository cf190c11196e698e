#include "appliance/wifi.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstddef>
#include <functional>
#include <nlohmann/json.hpp>
#include <system_error>

#include "octurn/error.hpp"
#include "octurn/json_object.hpp"
#include "one_line.hpp"

namespace octurn {
namespace {

/// Removes the front of a text up to and including the first `separator`.
/// @return the removed text, without the separator
std::string_view take_until(char separator, std::string_view& text) {
  const std::string_view taken = text.substr(0, text.find(separator));
  text.remove_prefix(std::min(taken.size() + 1, text.size()));
  return taken;
}

template <typename Number>
std::optional<Number> parse_number(std::string_view text, int base) {
  Number number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number, base);
  return error == std::errc() && end == text.data() + text.size() ? std::optional(number)
                                                                  : std::nullopt;
}

/// Removes an escape from the front of a text: `\xc3`, `\"`, `\\`, `\e`, `\n`, `\r` or `\t`
/// (wpa_supplicant, printf_encode in src/utils/common.c). @return its byte; nothing: no escape
std::optional<char> take_escape(std::string_view& text) {
  constexpr std::string_view letters = R"("\enrt)";
  constexpr std::array bytes{'"', '\\', '\x1b', '\n', '\r', '\t'};
  if (text.starts_with('x') && text.size() >= 3) {
    const auto byte = parse_number<unsigned char>(text.substr(1, 2), 16);
    text.remove_prefix(3);
    return byte ? std::optional(static_cast<char>(*byte)) : std::nullopt;
  }
  const std::size_t letter = text.empty() ? letters.npos : letters.find(text.front());
  if (letter == letters.npos) {
    return std::nullopt;
  }
  text.remove_prefix(1);
  return bytes[letter];
}

std::optional<std::string> unescaped(std::string_view text) {
  std::string bytes;
  while (!text.empty()) {
    const char c = text.front();
    text.remove_prefix(1);
    const std::optional<char> byte = c == '\\' ? take_escape(text) : c;
    if (!byte) {
      return std::nullopt;
    }
    bytes += *byte;
  }
  return bytes;
}

/// Parses a line: bssid, frequency, signal, flags and name, separated by tabs.
std::optional<WifiNetwork> network_in(std::string_view line) {
  take_until('\t', line);
  take_until('\t', line);
  const auto signal_dbm = parse_number<int>(take_until('\t', line), 10);
  const std::string_view flags = take_until('\t', line);
  const std::optional<std::string> name = unescaped(line);
  if (!signal_dbm || !name || !is_wifi_name(*name) || !is_utf8(*name)) {
    return std::nullopt;
  }
  const auto has = [&](std::string_view flag) { return flags.find(flag) != flags.npos; };
  return WifiNetwork{.name = *name,
                     .signal_dbm = *signal_dbm,
                     .secured = has("WPA") || has("WEP") || has("RSN") || has("SAE")};
}

}  // namespace

std::vector<WifiNetwork> wifi_networks(std::string_view scan_results) {
  std::vector<WifiNetwork> networks;
  take_until('\n', scan_results);  // the header line
  while (!scan_results.empty()) {
    if (auto network = network_in(take_until('\n', scan_results))) {
      networks.push_back(*std::move(network));
    }
  }
  std::ranges::stable_sort(networks, std::ranges::greater(), &WifiNetwork::signal_dbm);
  std::vector<WifiNetwork> strongest;
  for (WifiNetwork& network : networks) {
    if (std::ranges::find(strongest, network.name, &WifiNetwork::name) == strongest.end()) {
      strongest.push_back(std::move(network));
    }
  }
  return strongest;
}

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
