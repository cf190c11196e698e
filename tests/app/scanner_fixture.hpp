#pragma once

#include <gtest/gtest.h>

#include <functional>

#include "app/few_snapshots.hpp"
#include "app/frame_gate.hpp"
#include "run/scanner.hpp"
#include "support/patience.hpp"
#include "support/temporary_folder.hpp"

namespace octurn {

/// Waits until the status is as wanted, at most for `patience`. @return the last status
inline Status wait_until(const Scanner& scanner, const std::function<bool(const Status&)>& wanted) {
  const auto deadline = std::chrono::steady_clock::now() + patience;
  Status status = scanner.status();
  while (!wanted(status) && std::chrono::steady_clock::now() < deadline) {
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
    status = scanner.status();
  }
  return status;
}

/// Waits until the running scan has that many snapshots. @return the status then
inline Status wait_for_snapshots(const Scanner& scanner, int snapshots) {
  return wait_until(scanner, [=](const Status& status) {
    return status.job->snapshots_done >= snapshots || !status.busy();
  });
}

inline bool is_ready(const Status& status) {
  return status.sensor.state == DeviceStatus::State::ready;
}

class ScannerTest : public ::testing::Test {
 protected:
  static RigOptions rig() { return {.sensor_uri = "octurn-simulator://?speed=20", .speed = 20}; }

  /// Runs a scan to its end.
  static Job scan(Scanner& scanner, const ScanSettings& settings) {
    const auto started = scanner.start(settings);
    EXPECT_TRUE(started);
    const Status status = scanner.wait_until_done(patience);
    EXPECT_FALSE(status.busy());
    return *status.job;
  }

  TemporaryFolder folder_;
  ScanStore store_{folder_.path()};
  FrameGate gate_;  // for a scanner of a test
};

}  // namespace octurn
