#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace octurn {

/// A WiFi in reach.
struct WifiNetwork {
  std::string name = {};
  int signal_dbm = 0;
  bool secured = false;  ///< it asks for a password
};

/// The networks of a table that `wpa_cli scan_results` printed: each name once, as its strongest
/// station has it, the strongest first. Left out are hidden networks and names that nobody could
/// type or choose: not UTF-8, with control characters, or with blanks around them.
std::vector<WifiNetwork> wifi_networks(std::string_view scan_results);

}  // namespace octurn
