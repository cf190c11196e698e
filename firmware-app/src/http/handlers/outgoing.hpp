#pragma once

#include <string_view>

#include "http/app.hpp"
#include "http/message.hpp"

namespace octurn {

// Webhooks, and printers that receive models. Answers never contain keys, nor more of an address
// than its origin (scheme, host, port): the rest may be secret.

Response list_webhooks(App& app);

/// Adds the webhook of the body. @throws Error "bad-json", "bad-settings", "disk-full"
Response add_webhook(App& app, const Request& request);

/// @throws Error "not-found"
Response remove_webhook(App& app, std::string_view id);

/// Sends the event "test" to a webhook. Answers 202. @throws Error "not-found"
Response test_webhook(App& app, std::string_view id);

Response list_printers(App& app);

/// Adds the printer of the body. @throws Error "bad-json", "bad-settings", "disk-full"
Response add_printer(App& app, const Request& request);

/// Trusts the certificate with the body's fingerprint, or none. @throws Error "not-found" as well
Response trust_printer(App& app, const Request& request, std::string_view id);

/// @throws Error "not-found"
Response remove_printer(App& app, std::string_view id);

/// Starts sending a scan's model to the printer that the body names. Answers 202 with Location.
/// @throws Error "bad-json", "bad-settings", "no-such-scan", "no-model", "busy"
Response send_to_printer(App& app, const Request& request, std::string_view id);

/// Sends the state of a scan's upload to a printer.
/// @throws Error "not-found"  if the scan's upload is not the last one since the daemon started
Response send_upload(App& app, std::string_view id);

/// Cancels a scan's upload to a printer. @throws Error "not-running"
Response cancel_upload(App& app, std::string_view id);

}  // namespace octurn
