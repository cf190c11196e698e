#include "http/event_board.hpp"

#include <algorithm>
#include <charconv>

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

}  // namespace octurn
