#pragma once

#include <chrono>
#include <filesystem>
#include <string>

namespace octurn {

/// Options of the HTTP server.
struct HttpOptions {
  std::string address = "0.0.0.0";           ///< to listen on; the default is every IPv4 interface
  int port = 8080;                           ///< 0: any free port
  std::filesystem::path password_file = {};  ///< the page's users; empty: no authentication
  std::chrono::milliseconds request_timeout =
      std::chrono::seconds(10);  ///< timeout of a stalled client
};

}  // namespace octurn
