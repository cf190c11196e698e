#pragma once

#include <semaphore>
#include <span>
#include <string_view>
#include <variant>
#include <vector>

#include "http/app.hpp"
#include "http/event_feed.hpp"
#include "http/message.hpp"

namespace octurn {

/// A method, and a path with `{id}` and `{number}` for its variable parts.
struct RouteName {
  std::string_view method;
  std::string_view path;
};

struct Route;

/// Answers requests for the page, `/Scan.stl` and `/api/v1`, as documented in web/API.md.
/// Thread-safe.
class Api {
 public:
  explicit Api(App app);

  /// Does not throw: errors are answered as application/problem+json.
  Response answer(const Request& request);

  /// Ends the streams of events, so that the server's threads return.
  void end_events() { events_.end(); }

  /// All routes except the page's, to compare them with the OpenAPI description.
  static std::vector<RouteName> routes();

 private:
  std::counting_semaphore<>* places_for(const Route& route);
  Response dispatch(const Request& request);

  App app_;
  EventFeed events_;
  // A request that waits for a device occupies a server thread. These limits leave threads free.
  std::counting_semaphore<> looks_{4};
  std::counting_semaphore<> starts_{4};
};

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
