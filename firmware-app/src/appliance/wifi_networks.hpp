#pragma once

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

}  // namespace octurn
