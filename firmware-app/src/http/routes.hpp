#pragma once

#include <span>
#include <string_view>
#include <variant>

#include "http/app.hpp"
#include "http/event_feed.hpp"
#include "http/message.hpp"

namespace octurn {

/// A handler takes only what it needs: the request, and the variable parts of its path.
using Handler =
    std::variant<Response (*)(App&), Response (*)(App&, const Request&),
                 Response (*)(EventFeed&, const Request&), Response (*)(App&, std::string_view id),
                 Response (*)(App&, const Request&, std::string_view id),
                 Response (*)(App&, std::string_view id, std::string_view number),
                 Response (*)(App&, const Request&, std::string_view id, std::string_view number)>;

/// What a handler may wait for, up to some seconds: a frame of the sensor, or the start of devices.
enum class WaitsFor { nothing, look, start };

/// The handler of a method and a path, with `{id}` and `{number}` for its variable parts.
struct Route {
  std::string_view method;
  std::string_view path;
  Handler handler;
  WaitsFor waits_for = WaitsFor::nothing;
};

// The paths whose bodies are uploads.
inline constexpr std::string_view update_path = "/api/v1/update";

std::span<const Route> scan_routes();
std::span<const Route> other_routes();

}  // namespace octurn
