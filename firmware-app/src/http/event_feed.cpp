#include "http/event_feed.hpp"

#include <algorithm>
#include <charconv>
#include <exception>
#include <random>

#include "log.hpp"

namespace octurn {

void EventBoard::publish(const std::vector<News>& news) {
  for (const News& latest : news) {
    const auto before = std::ranges::find(entries_, latest.kind,
                                          [](const Entry& entry) { return entry.news.kind; });
    if (before != entries_.end()) {
      if (before->news.data == latest.data) {
        continue;
      }
      entries_.erase(before);
    }
    entries_.push_back({.news = latest, .number = ++newest_});
  }
}

std::uint64_t EventBoard::number(std::string_view last_event_id) const {
  const std::string prefix = run_ + "-";
  if (!last_event_id.starts_with(prefix)) {
    return 0;
  }
  last_event_id.remove_prefix(prefix.size());
  const char* const end = last_event_id.data() + last_event_id.size();
  std::uint64_t number = 0;
  const auto read = std::from_chars(last_event_id.data(), end, number);
  return read.ec == std::errc() && read.ptr == end && number <= newest_ ? number : 0;
}

std::string EventBoard::events_after(std::uint64_t& seen) const {
  std::string text;
  for (const Entry& entry : entries_) {
    if (entry.number > seen) {
      text += "id: " + run_ + "-" + std::to_string(entry.number) + "\nevent: " + entry.news.kind +
              "\ndata: " + entry.news.data + "\n\n";
    }
  }
  seen = newest_;
  return text;
}

namespace {

using Clock = std::chrono::steady_clock;

/// Reconnection time of clients, in milliseconds: shorter than the page's delay before it reports
/// that the scanner is away.
constexpr std::string_view greeting = "retry: 1000\n\n";

/// An event rather than an SSE comment, as browsers do not pass comments to scripts.
constexpr std::string_view heartbeat_event = "event: heartbeat\ndata: {}\n\n";

bool put(std::string_view text, const ByteSink& sink) {
  return sink(std::as_bytes(std::span(text)));
}

}  // namespace

/// A watcher's place among `max_watchers`, given back at the end of its lifetime.
class EventFeed::Place {
 public:
  explicit Place(EventFeed& feed) noexcept : feed_(&feed) {}
  Place(Place&& other) noexcept : feed_(std::exchange(other.feed_, nullptr)) {}
  Place& operator=(Place&&) = delete;
  ~Place() {
    if (feed_ != nullptr) {
      const std::lock_guard lock(feed_->mutex_);
      --feed_->watchers_;
    }
  }

 private:
  EventFeed* feed_;
};

EventFeed::EventFeed(Poll poll, const FeedLimits& limits)
    : poll_(std::move(poll)), limits_(limits), board_(std::to_string(std::random_device{}())) {}

std::optional<ByteStream> EventFeed::watch(std::string_view last_event_id) {
  std::uint64_t seen = 0;
  {
    const std::lock_guard lock(mutex_);
    if (watchers_ >= limits_.max_watchers) {
      return std::nullopt;
    }
    seen = board_.number(last_event_id);
    ++watchers_;
  }
  Place place(*this);  // without the lock, which its destructor takes if the task cannot be made
  ByteStream stream;
  stream.make = std::packaged_task<void(const ByteSink&)>(
      [this, seen, place = std::move(place)](const ByteSink& sink) { stream_events(seen, sink); });
  return stream;
}

void EventFeed::end() {
  {
    const std::lock_guard lock(mutex_);
    ended_ = true;
  }
  ended_changed_.notify_all();
}

/// Polls if the last poll is too old. @return the events that the watcher has not received
std::string EventFeed::next_events(std::uint64_t& seen) {
  const std::lock_guard lock(mutex_);
  if (const auto now = Clock::now(); now - polled_ >= limits_.poll_interval) {
    board_.publish(poll_());
    polled_ = now;
  }
  return board_.events_after(seen);
}

/// Waits for the polling interval. @return false if the streams are to end
bool EventFeed::wait() {
  std::unique_lock lock(mutex_);
  return !ended_changed_.wait_for(lock, limits_.poll_interval, [this] { return ended_; });
}

void EventFeed::stream_events(std::uint64_t seen, const ByteSink& sink) try {
  const auto begun = Clock::now();
  auto sent = begun;
  bool is_taken = put(greeting, sink);
  while (is_taken && Clock::now() - begun < limits_.lifetime) {
    std::string events = next_events(seen);
    if (events.empty() && Clock::now() - sent >= limits_.heartbeat) {
      events = heartbeat_event;
    }
    if (!events.empty()) {
      sent = Clock::now();
      is_taken = put(events, sink);
    }
    if (!wait()) {
      return;
    }
  }
} catch (const std::exception& error) {
  log::error("http", std::string("a stream of events has ended: ") + error.what());
}

}  // namespace octurn
