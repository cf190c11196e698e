#pragma once

#include <chrono>
#include <optional>
#include <string>

namespace octurn {

// Notifications to systemd (sd_notify(3)). Without systemd they do nothing.

/// Says that the daemon is ready. @param status  a line for `systemctl status`
void notify_ready(const std::string& status);

/// Says that the daemon is ending.
void notify_stopping();

/// Timeout of systemd's watchdog; nothing if it is off.
std::optional<std::chrono::microseconds> watchdog_interval();

/// Resets the watchdog's timeout.
void notify_alive();

}  // namespace octurn
