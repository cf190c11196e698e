#pragma once

#include <chrono>
#include <filesystem>
#include <string>
#include <vector>

namespace octurn {

/// Options of the HTTP server.
struct HttpOptions {
  std::string address = "0.0.0.0";  ///< to listen on; the default is every IPv4 interface
  int port = 8080;                  ///< 0: any free port
  /// Addresses of proxies whose headers X-Forwarded-Host and -For are believed.
  std::vector<std::string> trusted_proxies = {};
  std::filesystem::path password_file = {};      ///< with the page's password; empty: there is none
  std::filesystem::path own_password_file = {};  ///< overrides it while it exists
  /// How long the port may be taken by another program, as between two servers of this one.
  std::chrono::milliseconds bind_patience{0};
  std::chrono::milliseconds request_timeout =
      std::chrono::seconds(10);  ///< timeout of a stalled client
};

}  // namespace octurn
