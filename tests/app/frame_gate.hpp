#pragma once

#include <condition_variable>
#include <memory>
#include <mutex>
#include <stop_token>
#include <string>
#include <utility>

#include "app/wrapped_sensor.hpp"
#include "run/scanner.hpp"

namespace octurn {

/// Holds back a sensor's frames, so that a scan stays at a stop while a test acts, and cannot end
/// before.
class FrameGate {
 public:
  /// Puts a rig's sensor behind this gate, which must outlive the rig's scanner.
  RigOptions before(RigOptions rig) {
    rig.open_sensor = [this, open = std::move(rig.open_sensor)](const std::string& uri) {
      return std::make_unique<Sensor>(*this, open(uri));
    };
    return rig;
  }

  /// Lets no frame of a scan through once it has so many snapshots, until `let_go`. A stop request
  /// ends the wait as it ends that for any frame.
  void hold(const Scanner& scanner, int snapshots) {
    const std::lock_guard lock(mutex_);
    scanner_ = &scanner;
    snapshots_ = snapshots;
    changed_.notify_all();
  }

  void let_go() {
    const std::lock_guard lock(mutex_);
    scanner_ = nullptr;
    changed_.notify_all();
  }

 private:
  class Sensor final : public WrappedSensor {
   public:
    Sensor(FrameGate& gate, std::unique_ptr<DepthSensor> sensor)
        : WrappedSensor(std::move(sensor)), gate_(gate) {}
    std::optional<TimedFrame> read(const std::stop_token& stop) override {
      gate_.pass(stop);
      return WrappedSensor::read(stop);
    }

   private:
    FrameGate& gate_;
  };

  void pass(const std::stop_token& stop) {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, stop, [this] { return !is_held(); });
  }

  bool is_held() const {
    const Status status = scanner_ != nullptr ? scanner_->status() : Status();
    return status.is_scanning() && status.job->snapshots_done >= snapshots_;
  }

  std::mutex mutex_ = {};  // guards what follows
  std::condition_variable_any changed_ = {};
  const Scanner* scanner_ = nullptr;
  int snapshots_ = 0;
};

}  // namespace octurn
