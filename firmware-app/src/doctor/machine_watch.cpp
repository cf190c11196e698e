#include "doctor/machine_watch.hpp"

#include <exception>
#include <string>
#include <utility>

#include "log.hpp"
#include "rig/interruptible_sleep.hpp"

namespace octurn {

MachineWatch::MachineWatch(Looks looks, const WatchIntervals& intervals)
    : looks_(std::move(looks)), intervals_(intervals) {
  look(std::chrono::steady_clock::now());
  thread_ = std::jthread([this](const std::stop_token& stop) { run(stop); });
}

void MachineWatch::look(Time now) {
  MachineHealth health = *health_.get();
  std::string trouble;
  try {
    health.disk_free_bytes = looks_.free_bytes();
    if (!warnings_looked_ || now - *warnings_looked_ >= intervals_.warnings) {
      warnings_looked_ = now;
      health.warnings = looks_.warnings();
    }
  } catch (const std::exception& error) {
    trouble = error.what();
  }
  if (!trouble.empty() && trouble != trouble_) {
    log::warning("machine", trouble);
  }
  trouble_ = std::move(trouble);
  if (health != *health_.get()) {
    health_.set(std::move(health));
  }
}

void MachineWatch::run(const std::stop_token& stop) {
  while (sleep_for(stop, intervals_.disk)) {
    look(std::chrono::steady_clock::now());
  }
}

}  // namespace octurn
