#pragma once

#include <vector>

#include "http/app.hpp"
#include "http/event_feed.hpp"
#include "http/message.hpp"

namespace octurn {

/// What watchers are told, each whenever it changes: "status" as GET status, "devices" of it,
/// "scans" by their revision, and "warnings" about the machine.
std::vector<News> latest_news(const App& app);

/// A stream of it; 503 "too-many" with Retry-After where too many watch already.
Response send_events(EventFeed& feed, const Request& request);

}  // namespace octurn
