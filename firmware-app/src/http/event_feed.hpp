#pragma once

#include <chrono>
#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string_view>
#include <vector>

#include "http/event_board.hpp"
#include "http/message.hpp"

namespace octurn {

/// Limits of event streams.
struct FeedLimits {
  int max_watchers = 8;  ///< each occupies a thread of the server
  std::chrono::milliseconds poll_interval{250};
  std::chrono::milliseconds heartbeat{
      3000};  ///< sent after so long without an event; detects closed connections
  std::chrono::milliseconds lifetime = std::chrono::minutes(10);  ///< of one stream
};

/// Streams changes to watchers as server-sent events. The first watcher that finds the last poll
/// too old polls for all, so that many watchers cost as much as one, and no watcher costs nothing.
/// Thread-safe.
class EventFeed {
 public:
  using Poll = std::function<std::vector<News>()>;

  /// @param poll  returns the current events; called by one thread at a time
  explicit EventFeed(Poll poll, const FeedLimits& limits = {});

  /// A stream of events for a new watcher, which must not outlive the feed. Nothing if there are
  /// `max_watchers` already.
  /// @param last_event_id  of the last event that it received: older events are left out
  std::optional<ByteStream> watch(std::string_view last_event_id);

  /// Ends all streams, and those to come, at once.
  void end();

 private:
  class Place;

  void stream_events(std::uint64_t seen, const ByteSink& sink);
  std::string next_events(std::uint64_t& seen);
  bool wait();

  Poll poll_;
  FeedLimits limits_;
  std::mutex mutex_ = {};  // guards what follows
  std::condition_variable ended_changed_ = {};
  bool ended_ = false;
  int watchers_ = 0;
  EventBoard board_;
  std::chrono::steady_clock::time_point polled_ = {};
};

}  // namespace octurn
