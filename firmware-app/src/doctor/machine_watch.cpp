#include "doctor/machine_watch.hpp"

#include <exception>
#include <string>
#include <utility>

#include "log.hpp"
#include "rig/interruptible_sleep.hpp"

namespace octurn {

MachineWatch::MachineWatch(Sources sources, const WatchIntervals& intervals)
    : sources_(std::move(sources)), intervals_(intervals) {
  poll(std::chrono::steady_clock::now());
  thread_ = std::jthread([this](const std::stop_token& stop) { run(stop); });
}

void MachineWatch::poll(Time now) {
  MachineHealth health = *health_.get();
  std::string trouble;
  try {
    health.disk_free_bytes = sources_.free_bytes();
    if (!warnings_polled_ || now - *warnings_polled_ >= intervals_.warnings) {
      warnings_polled_ = now;
      health.warnings = sources_.warnings();
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
    poll(std::chrono::steady_clock::now());
  }
}

}  // namespace octurn
