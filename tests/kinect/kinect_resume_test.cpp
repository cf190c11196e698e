// Scans of the daemon during which its emulated Kinect fails.

#include <gtest/gtest.h>

#include <csignal>
#include <nlohmann/json.hpp>
#include <thread>
#include <tuple>

#include "kinect/kinect_on_desk.hpp"
#include "kinect/kinect_view.hpp"
#include "support/daemon.hpp"
#include "support/patience.hpp"

namespace octurn {
namespace {

using nlohmann::json;

const std::string settings = R"({"snapshots": 12, "frames": 2, "leaf_size_mm": 4})";

struct Fault {
  const char* name;
  void (*begin)(KinectOnDesk& desk);
  void (*end)(KinectOnDesk& desk);
  const char* code;
};

std::ostream& operator<<(std::ostream& out, const Fault& fault) { return out << fault.name; }

const Fault silent{"silent", [](KinectOnDesk& desk) { desk->silent = true; },
                   [](KinectOnDesk& desk) { desk->silent = false; }, "sensor-silent"};
const Fault unplugged{"unplugged", [](KinectOnDesk& desk) { desk.unplug(); },
                      [](KinectOnDesk& desk) { desk.plug_in(); }, "sensor-missing"};
const Fault damaged{"damaged", [](KinectOnDesk& desk) { desk->random_loss = 0.3; },
                    [](KinectOnDesk& desk) { desk->random_loss = 0; }, "sensor-silent"};

/// A daemon's Kinect that fails in a scan.
class FailingKinect {
 public:
  /// @param speed  of the turntable: a failing stop is retried for 30 s / speed
  FailingKinect(const Fault& fault, const std::string& speed)
      : fault_(fault),
        daemon_(folder_.path(), {"--sensor", "kinect://", "--simulate-speed", speed}) {}

  Daemon& daemon() { return daemon_; }
  void mend() { fault_.end(desk_); }

  /// Posts until it is accepted: a Kinect is not ready at once.
  Reply post_until_accepted(const std::string& path, const std::string& body) const {
    const auto deadline = std::chrono::steady_clock::now() + patience;
    Reply reply = daemon_.post(path, body);
    while (reply.status != 202 && std::chrono::steady_clock::now() < deadline) {
      reply = daemon_.post(path, body);
    }
    EXPECT_EQ(reply.status, 202) << reply.body;
    return reply;
  }

  /// Starts a scan, and lets the Kinect fail when it has so many snapshots. Once more where the
  /// scan has ended before: a busy machine may delay this process.
  /// @return the scan's path
  std::string scan_that_fails(int snapshots) {
    for (;;) {
      const std::string scan = post_until_accepted("/api/v1/scans", settings).header("Location");
      daemon_.wait_until(scan, [&](const json& now) {
        return now["snapshots_done"] >= snapshots || now["state"] != "running";
      });
      fault_.begin(desk_);
      const json failed = daemon_.wait_until(scan, [](const json& now) {
        return now["error"] != nullptr || now["state"] != "running";
      });
      if (failed["state"] != "finished") {
        return scan;
      }
      mend();
    }
  }

 private:
  Fault fault_;
  KinectOnDesk desk_{{readings_of(simulated_frame())}};
  TemporaryFolder folder_ = {};
  Daemon daemon_;
};

class KinectFaults : public ::testing::TestWithParam<std::tuple<Fault, int>> {};

TEST_P(KinectFaults, PauseAScanThatIsResumedWhenTheyAreMended) {
  const auto& [fault, stop] = GetParam();
  FailingKinect kinect(fault, "20");
  const Daemon& daemon = kinect.daemon();
  ASSERT_EQ(daemon.wait_until_done(daemon.start(settings))["state"], "finished");
  const std::string model = daemon.get("/Scan.stl").body;

  const std::string scan = kinect.scan_that_fails(stop);
  const json paused = daemon.wait_until_done(scan);
  ASSERT_EQ(paused["state"], "paused") << paused;
  EXPECT_EQ(paused["error"]["code"], fault.code);
  EXPECT_GE(paused["snapshots_done"], stop);
  EXPECT_EQ(daemon.post(scan + "/resume", "").status, 503);

  kinect.mend();
  kinect.post_until_accepted(scan + "/resume", "");
  const json done = daemon.wait_until_done(scan);
  ASSERT_EQ(done["state"], "finished") << done;
  EXPECT_TRUE(daemon.get(scan + "/Scan.stl").body == model);
}

INSTANTIATE_TEST_SUITE_P(AtEachStop, KinectFaults,
                         ::testing::Combine(::testing::Values(silent, unplugged, damaged),
                                            ::testing::Range(0, 4)));

class KinectFaultsThatPass : public ::testing::TestWithParam<Fault> {};

// ScanFaults tests the same at each stop.
TEST_P(KinectFaultsThatPass, DoNotPauseAScan) {
  FailingKinect kinect(GetParam(), "1");
  const std::string scan = kinect.scan_that_fails(1);
  const json trying = parsed(kinect.daemon().get(scan));
  EXPECT_EQ(trying["state"], "running");
  EXPECT_EQ(trying["error"].value("code", "").substr(0, 7), "sensor-");
  kinect.mend();
  const json done = kinect.daemon().wait_until_done(scan);
  EXPECT_EQ(done["state"], "finished") << done;
  EXPECT_EQ(done["error"], nullptr);
}

/// Has the system stop a daemon for longer than a sensor may be silent, and than opening one takes.
/// @param meanwhile  called while it is stopped
template <typename Meanwhile>
void stop_for_a_while(Daemon& daemon, Meanwhile meanwhile) {
  daemon.program().send_signal(SIGSTOP);
  meanwhile();
  std::this_thread::sleep_for(std::chrono::seconds(5));  // the fault is that real time passes
  daemon.program().send_signal(SIGCONT);
}

TEST(StoppedDaemon, GoesOnWithItsScan) {
  KinectOnDesk desk({readings_of(simulated_frame())});
  desk->is_hasty = true;
  const TemporaryFolder folder;
  Daemon daemon(folder.path(), {"--sensor", "kinect://", "--simulate-speed", "5"});
  const std::string scan = daemon.start(settings);
  daemon.wait_until(scan, [](const json& now) { return now["snapshots_done"] >= 1; });
  stop_for_a_while(daemon, [] {});
  const json done = daemon.wait_until_done(scan);
  EXPECT_EQ(done["state"], "finished") << done;
}

TEST(StoppedDaemon, OpensItsKinectAfterAll) {
  const Fault plugged_in_again{"plugged in again",
                               [](KinectOnDesk& desk) {
                                 desk->stalls = 1'000'000;  // it does not open
                                 desk.unplug();
                                 desk.plug_in();
                               },
                               [](KinectOnDesk& desk) { desk->stalls = 0; }, "sensor-failed"};
  FailingKinect kinect(plugged_in_again, "1");
  const std::string scan = kinect.scan_that_fails(1);
  stop_for_a_while(kinect.daemon(), [&] { kinect.mend(); });
  const json done = kinect.daemon().wait_until_done(scan);
  EXPECT_EQ(done["state"], "finished") << done;
}

INSTANTIATE_TEST_SUITE_P(Each, KinectFaultsThatPass, ::testing::Values(silent, unplugged, damaged));

}  // namespace
}  // namespace octurn
