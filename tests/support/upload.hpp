#pragma once

#include <cstddef>
#include <string>

#include "support/daemon.hpp"

namespace octurn {

constexpr const char* update_path = "/api/v1/update";

/// The request head of an update. @param more  further headers, each with its line end
inline std::string head_of_upload(std::size_t bytes, const std::string& more = "",
                                  const std::string& query = "") {
  return std::string("PUT ") + update_path + query + " HTTP/1.1\r\nHost: localhost\r\n" +
         "Content-Type: application/octet-stream\r\nContent-Length: " + std::to_string(bytes) +
         "\r\n" + more + "\r\n";
}

/// Uploads an update bundle.
inline Reply upload(const Daemon& daemon, const std::string& bundle, const std::string& more = "",
                    const std::string& query = "") {
  return reply_to(daemon.port(), head_of_upload(bundle.size(), more, query) + bundle);
}

}  // namespace octurn
