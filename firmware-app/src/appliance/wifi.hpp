#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace octurn {

/// A WiFi in reach.
struct WifiNetwork {
  std::string name = {};
  int signal_dbm = 0;
  bool secured = false;  ///< needs a password
};

/// Parses the table of `wpa_cli scan_results`: each name once, with its strongest access point,
/// strongest first. Leaves out hidden networks and names that cannot be typed or requested: not
/// UTF-8, with control characters, or with blanks around them.
std::vector<WifiNetwork> wifi_networks(std::string_view scan_results);

/// A request to join a WiFi.
struct WifiRequest {
  std::string name = {};
  std::optional<std::string> password = {};  ///< nothing: an open WiFi
  std::string country = {};                  ///< two capital letters
};

/// Whether a WiFi of that name can be requested: octurn.txt has names on one line, without quotes.
bool is_wifi_name(std::string_view name);

/// Reads {"name", "password", "country"}.
/// @throws Error "bad-wifi"  whose texts never contain the password
WifiRequest wifi_request_from(const nlohmann::json& body);

/// The request as lines of octurn.txt.
std::string to_text(const WifiRequest& request);

}  // namespace octurn
