#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <string_view>

namespace octurn {

/// A WiFi that somebody wants the scanner to join.
struct WifiRequest {
  std::string name = {};
  std::optional<std::string> password = {};  ///< nothing: an open WiFi
  std::string country = {};                  ///< two capital letters
};

/// Whether a WiFi of that name can be asked for: octurn.txt has it in a line, without quotes.
bool is_wifi_name(std::string_view name);

/// Reads {"name", "password", "country"}.
/// @throws Error "bad-wifi"  which never has the password in it
WifiRequest wifi_request_from(const nlohmann::json& body);

/// The request as octurn.txt has it.
std::string to_text(const WifiRequest& request);

}  // namespace octurn
