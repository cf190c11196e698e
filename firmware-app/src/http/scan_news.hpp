#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <tuple>
#include <vector>

#include "http/app.hpp"
#include "outgoing/webhook_sender.hpp"

namespace octurn {

/// The states of scans, by their ids.
using ScanStates = std::map<std::string, JobState>;

/// A scan, and the webhook event of its new state.
struct ScanEvent {
  std::string event = {};
  std::string id = {};
};

/// The changes between two polls.
/// @param newest  the last id before: a scan that appeared with an older id was restored from the
///                bin, and is no news
std::vector<ScanEvent> changes(const ScanStates& before, const ScanStates& now,
                               const std::string& newest);

/// Detects changes of the scans and the machine from one poll to the next. The first poll finds
/// none. Not thread-safe.
class ScanNews {
 public:
  std::vector<WebhookEvent> next(const App& app);

 private:
  using Mark = std::tuple<std::uint64_t, std::string, JobState>;

  std::vector<ScanEvent> next_scans(const App& app);
  std::vector<WebhookEvent> next_warnings(const App& app);

  std::optional<Mark> mark_ = {};  // of the last poll; while it is the same, no scan has changed
  ScanStates states_ = {};
  std::string newest_ = {};
  std::optional<std::set<std::string>> warnings_ = {};  // checks that warned at the last poll
};

/// The event "test", which carries no data: it shows that a webhook works.
WebhookEvent make_test_event();

}  // namespace octurn
