#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace octurn {

/// One kind of news, and all that there is to it now: the newest replaces what came before.
struct News {
  std::string kind = {};  ///< "status"
  std::string data = {};  ///< one line of JSON
};

/// The newest of each kind of news, numbered in the order in which they changed, and what of it a
/// client has not had yet as server-sent events (HTML Living Standard, section 9.2).
///
/// Not thread-safe.
class EventBoard {
 public:
  /// @param run  letters and digits that no other board has: numbers of another mean nothing here
  explicit EventBoard(std::string run) : run_(std::move(run)) {}

  /// Takes what has changed since it was published last.
  void publish(const std::vector<News>& news);

  /// The number of the last event that a client has had.
  /// @param last_event_id  as it sends it; 0, as for one that has had none, if it is not of this
  /// run
  std::uint64_t number(std::string_view last_event_id) const;

  /// The events that came after one, oldest first; empty if there are none.
  /// @param seen  its number; that of the newest afterwards
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
