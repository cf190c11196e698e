#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "http/app.hpp"
#include "http/event_feed.hpp"
#include "http/message.hpp"

namespace octurn {

/// What watchers are told, each whenever it changes: "status" as GET status, "devices" of it,
/// "scans" by their revision, and "warnings" about the machine. Touches no disk.
class StatusNews {
 public:
  explicit StatusNews(const App& app) : app_(app) {}

  /// Makes the news. Empty if nothing has changed since the call before: then it makes no status.
  std::vector<News> operator()();

 private:
  /// All that a status is made of. What is published anew is another object.
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

/// A stream of it; 503 "too-many" with Retry-After where too many watch already.
Response send_events(EventFeed& feed, const Request& request);

}  // namespace octurn
