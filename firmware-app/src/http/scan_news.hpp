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

/// What has become of the scans, by their ids.
using ScanStates = std::map<std::string, JobState>;

/// A scan, and the event of webhooks that tells what has become of it.
struct ScanEvent {
  std::string event = {};
  std::string id = {};
};

/// What has changed between two looks.
/// @param newest  the last id that any scan had before: what came since and is no newer than that
///                is no news: it was taken out of the bin
std::vector<ScanEvent> changes(const ScanStates& before, const ScanStates& now,
                               const std::string& newest);

/// What has happened to the scans and the machine from one look to the next. The first look finds
/// nothing. Not thread-safe.
class ScanNews {
 public:
  std::vector<Happening> next(const App& app);

 private:
  using Mark = std::tuple<std::uint64_t, std::string, JobState>;

  std::vector<ScanEvent> next_scans(const App& app);
  std::vector<Happening> next_warnings(const App& app);

  std::optional<Mark> mark_ = {};  // of the last look: if it is the same, nothing has happened
  ScanStates states_ = {};
  std::string newest_ = {};
  std::optional<std::set<std::string>> warnings_ = {};  // their checks
};

/// That tells nothing but that it works.
Happening test_happening();

}  // namespace octurn
