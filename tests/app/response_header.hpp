#pragma once

#include <algorithm>
#include <string>
#include <string_view>

#include "http/http_server.hpp"

namespace octurn {

/// The value of a response's header; empty if it has none of that name.
inline std::string header(const Response& response, std::string_view name) {
  const auto found = std::ranges::find(response.headers, name, &Headers::value_type::first);
  return found == response.headers.end() ? "" : found->second;
}

}  // namespace octurn
