#pragma once

#include <chrono>
#include <filesystem>
#include <string>

namespace octurn {

/// Where the page is served, and to whom.
struct HttpOptions {
  std::string address = "0.0.0.0";  ///< to listen on; the default is every one of this machine
  int port = 8080;                  ///< 0: any free one
  std::filesystem::path password_file = {};  ///< who may open it; empty: everybody
  std::chrono::milliseconds patience = std::chrono::seconds(10);  ///< with a client that stalls
};

}  // namespace octurn
