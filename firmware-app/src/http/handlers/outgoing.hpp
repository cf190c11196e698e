#pragma once

#include <string_view>

#include "http/app.hpp"
#include "http/message.hpp"

namespace octurn {

// Whom the scanner tells what happens, and sends models to. Keys, and of addresses all but scheme,
// host and port, are never told again: they may be secret.

Response list_webhooks(App& app);

/// Adds the webhook of the body. @throws Error "bad-json", "bad-settings", "disk-full"
Response add_webhook(App& app, const Request& request);

/// @throws Error "not-found"
Response remove_webhook(App& app, std::string_view id);

/// Tells a webhook the event "test". @throws Error "not-found"
Response test_webhook(App& app, std::string_view id);

Response list_printers(App& app);

/// Adds the printer of the body. @throws Error "bad-json", "bad-settings", "disk-full"
Response add_printer(App& app, const Request& request);

/// @throws Error "not-found"
Response remove_printer(App& app, std::string_view id);

/// Begins to send a scan's model to the printer that the body names.
/// @throws Error "bad-json", "bad-settings", "no-such-scan", "no-model", "busy"
Response send_to_printer(App& app, const Request& request, std::string_view id);

/// How far that is. @throws Error "not-found"  if it was not sent since the daemon started, or
/// another scan was sent after it
Response send_upload(App& app, std::string_view id);

/// @throws Error "not-running"
Response cancel_upload(App& app, std::string_view id);

}  // namespace octurn
