#pragma once

#include <semaphore>
#include <string_view>
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

}  // namespace octurn
