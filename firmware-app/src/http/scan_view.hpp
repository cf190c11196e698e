#pragma once

#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <string_view>
#include <vector>

#include "http/app.hpp"

namespace octurn {

// The current state of scans: of the running one from the scanner, of the others as stored.

/// @throws Error "no-such-scan"
Job find_scan(const App& app, std::string_view id);

/// The newest first.
std::vector<Job> all_scans(const App& app);

/// The scan that runs; nothing if none does.
std::optional<Job> running_scan(const App& app);

/// A scan as web/API.md has it.
nlohmann::json to_json(const App& app, const Job& job);

/// Shows each of them as web/API.md has it, the newest first.
void for_each_scan(const App& app, const std::function<void(nlohmann::json)>& show);

}  // namespace octurn
