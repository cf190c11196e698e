#pragma once

#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <string_view>
#include <vector>

#include "http/app.hpp"

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

}  // namespace octurn
