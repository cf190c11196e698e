#pragma once

#include <chrono>
#include <optional>
#include <string>

namespace octurn {

// What systemd is told of the daemon, as sd_notify(3) has it. Started by hand, nobody listens, and
// all of this does nothing.

/// The daemon serves from now on. @param status  a line for `systemctl status`
void notify_ready(const std::string& status);

void notify_stopping();

/// How long systemd waits for a sign of life before it restarts the daemon; nothing if it does not.
std::optional<std::chrono::microseconds> watchdog_interval();

/// A sign of life.
void notify_alive();

}  // namespace octurn
