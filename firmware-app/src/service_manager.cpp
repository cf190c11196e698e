#include "service_manager.hpp"

#include <systemd/sd-daemon.h>

#include <cstdint>

namespace octurn {

void notify_ready(const std::string& status) {
  ::sd_notify(0, ("READY=1\nSTATUS=" + status).c_str());
}

void notify_stopping() { ::sd_notify(0, "STOPPING=1"); }

std::optional<std::chrono::microseconds> watchdog_interval() {
  std::uint64_t microseconds = 0;
  return ::sd_watchdog_enabled(0, &microseconds) > 0
             ? std::optional(std::chrono::microseconds(microseconds))
             : std::nullopt;
}

void notify_alive() { ::sd_notify(0, "WATCHDOG=1"); }

}  // namespace octurn
