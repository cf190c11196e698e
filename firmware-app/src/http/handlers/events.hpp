#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "http/app.hpp"
#include "http/event_feed.hpp"
#include "http/message.hpp"

namespace octurn {

/// Source of the server-sent events: "status" as GET status, its "devices" and "warnings", and the
/// revision of "scans". Touches no disk.
class StatusNews {
 public:
  explicit StatusNews(const App& app) : app_(app) {}

  /// Returns the current events; empty if nothing has changed since the last call, at low cost.
  std::vector<News> operator()();

 private:
  /// The inputs of a status. Publishing replaces an object, so that comparing pointers is enough.
  struct Sources {
    std::shared_ptr<const Status> status = {};
    std::shared_ptr<const std::optional<BuildRun>> build = {};
    std::shared_ptr<const std::vector<BuildRun>> cluster_builds = {};
    std::shared_ptr<const MachineHealth> machine = {};
    std::uint64_t scans_revision = 0;
    friend bool operator==(const Sources&, const Sources&) = default;
  };

  const App& app_;
  Sources before_ = {};
};

/// Streams events to a client; 503 "too-many" with Retry-After if too many clients watch already.
Response send_events(EventFeed& feed, const Request& request);

}  // namespace octurn
