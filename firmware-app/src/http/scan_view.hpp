#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <tuple>
#include <vector>

#include "http/app.hpp"
#include "outgoing/webhook_sender.hpp"

namespace octurn {

// The current state of scans: of the running one from the scanner, of the others as stored.

/// The scan of that id. @throws Error "no-such-scan"
Job find_scan(const App& app, std::string_view id);

/// All scans, newest first.
std::vector<Job> all_scans(const App& app);

/// The scan that runs; nothing if none does.
std::optional<Job> running_scan(const App& app);

/// A scan as in web/API.md, with its preview and its other poses.
nlohmann::json to_json(const App& app, const Job& job);

/// Calls `show` with the JSON of each scan, newest first. Only one document exists at a time.
void for_each_scan(const App& app, const std::function<void(nlohmann::json)>& show);

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
