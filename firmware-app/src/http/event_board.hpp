#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

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

}  // namespace octurn
