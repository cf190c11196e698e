#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "http/message.hpp"

namespace octurn {

/// The current state of one kind of event; a newer one replaces it.
struct News {
  std::string kind = {};  ///< "status"
  std::string data = {};  ///< one line of JSON
};

/// The newest event of each kind, numbered in the order of change, and formatted as server-sent
/// events (HTML Living Standard, section 9.2) for clients that have not received them yet.
///
/// Not thread-safe.
class EventBoard {
 public:
  /// @param run  letters and digits unique to this board, as event numbers of other boards are
  ///             invalid
  explicit EventBoard(std::string run) : run_(std::move(run)) {}

  /// Adds the events that differ from the last published ones.
  void publish(const std::vector<News>& news);

  /// The number of the last event that a client received; 0 if it received none of this run.
  /// @param last_event_id  as sent by the client
  std::uint64_t number(std::string_view last_event_id) const;

  /// The events after number `seen`, oldest first; empty if there are none.
  /// @param seen  is set to the number of the newest
  std::string events_after(std::uint64_t& seen) const;

 private:
  struct Entry {
    News news = {};
    std::uint64_t number = 0;
  };

  std::string run_;
  std::vector<Entry> entries_ = {};  // in the order of their numbers
  std::uint64_t newest_ = 0;
};

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
