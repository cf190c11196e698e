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

/// How often watchers are told something, and for how long.
struct FeedLimits {
  int max_watchers = 8;  ///< each holds a thread of the server for as long as it watches
  std::chrono::milliseconds look_interval{250};
  std::chrono::milliseconds heartbeat{3000};  ///< after so long without news; finds who has gone
  std::chrono::milliseconds lifetime = std::chrono::minutes(10);  ///< of one stream
};

/// Tells watchers what changes, by server-sent events. Whoever finds that the last look is old
/// takes the next one for all, so that many watchers cost as much as one, and none costs nothing.
///
/// Any thread may call it.
class EventFeed {
 public:
  using Look = std::function<std::vector<News>()>;

  /// @param look  all there is to tell now; one call at a time
  explicit EventFeed(Look look, const FeedLimits& limits = {});

  /// A stream of events for one more watcher, which holds its place until the stream is destroyed.
  /// The feed has to outlive it. Nothing if all places are taken.
  /// @param last_event_id  of the last event that it has had; what has not changed since is left
  /// out
  std::optional<ByteStream> watch(std::string_view last_event_id);

  /// Ends all streams, and those to come, at once.
  void end();

 private:
  class Place;

  void tell(std::uint64_t seen, const ByteSink& sink);
  std::string next_events(std::uint64_t& seen);
  bool wait();

  Look look_;
  FeedLimits limits_;
  std::mutex mutex_ = {};  // guards what follows
  std::condition_variable ended_changed_ = {};
  bool ended_ = false;
  int watchers_ = 0;
  EventBoard board_;
  std::chrono::steady_clock::time_point looked_ = {};
};

}  // namespace octurn
