// Scans of the daemon that its emulated Kinect leaves in the lurch.

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "emulation/kinect_on_desk.hpp"
#include "emulation/kinect_view.hpp"
#include "support/daemon.hpp"

namespace octurn {
namespace {

using nlohmann::json;

std::string settings(int snapshots) {
  return json{{"snapshots", snapshots}, {"frames", 2}, {"leaf_size_mm", 4}}.dump();
}

struct Fault {
  const char* name;
  void (*begin)(KinectOnDesk& desk);
  void (*end)(KinectOnDesk& desk);
  const char* code;
};

std::ostream& operator<<(std::ostream& out, const Fault& fault) { return out << fault.name; }

class KinectFaults : public ::testing::TestWithParam<Fault> {
 protected:
  /// What a scan is once the Kinect has failed after so many snapshots.
  json scan_until(const Daemon& daemon, const std::string& scan, int snapshots,
                  const std::function<bool(const json&)>& wanted) {
    daemon.wait_until(scan, [&](const json& now) { return now["snapshots_done"] >= snapshots; });
    GetParam().begin(desk_);
    return daemon.wait_until(scan, wanted);
  }

  static bool has_stopped(const json& now) { return now["state"] != "running"; }

  /// The answer to a request to resume, asked again until the sensor is there.
  static Reply resumed(const Daemon& daemon, const std::string& scan) {
    const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(60);
    Reply reply;
    while (reply.status != 202 && std::chrono::steady_clock::now() < deadline) {
      reply = daemon.post(scan + "/resume", "");
    }
    return reply;
  }

  KinectOnDesk desk_{{readings_of(simulated_frame())}};
};

TEST_P(KinectFaults, PauseAScanAtStopAfterStopThatIsResumedWhenTheyAreMended) {
  const TemporaryFolder folder;
  const Daemon daemon(folder.path(), {"--sensor", "kinect://"});
  ASSERT_EQ(daemon.wait_until_done(daemon.start(settings(6)))["state"], "finished");
  const std::string model = daemon.get("/Scan.stl").body;

  const std::string scan = daemon.start(settings(6));
  json now = scan_until(daemon, scan, 0, has_stopped);
  int pauses = 0;
  for (; now["state"] == "paused"; ++pauses) {
    EXPECT_EQ(now["error"]["code"], GetParam().code);
    EXPECT_EQ(daemon.post(scan + "/resume", "").status, 503);
    GetParam().end(desk_);
    ASSERT_EQ(resumed(daemon, scan).status, 202);
    now = scan_until(daemon, scan, now["snapshots_done"].get<int>() + 1, has_stopped);
  }
  EXPECT_EQ(now["state"], "finished") << now;
  EXPECT_GE(pauses, 3);  // a fault may be too late for the stop that it was meant for
  EXPECT_TRUE(daemon.get(scan + "/Scan.stl").body == model);
}

TEST_P(KinectFaults, ThatPassDoNotPauseAScan) {
  const TemporaryFolder folder;
  const Daemon daemon(folder.path(), {"--sensor", "kinect://"});
  const std::string scan = daemon.start(settings(12));
  const json trying = scan_until(daemon, scan, 1, [](const json& now) {
    return now["error"] != nullptr || now["state"] != "running";
  });
  EXPECT_EQ(trying["state"], "running");
  EXPECT_EQ(trying["error"]["code"].get<std::string>().substr(0, 7), "sensor-");
  GetParam().end(desk_);
  const json done = daemon.wait_until_done(scan);
  EXPECT_EQ(done["state"], "finished") << done;
  EXPECT_EQ(done["error"], nullptr);
}

const Fault silent{"silent", [](KinectOnDesk& desk) { desk->silent = true; },
                   [](KinectOnDesk& desk) { desk->silent = false; }, "sensor-silent"};
const Fault unplugged{"unplugged", [](KinectOnDesk& desk) { desk.unplug(); },
                      [](KinectOnDesk& desk) { desk.plug_in(); }, "sensor-missing"};
const Fault damaged{"damaged", [](KinectOnDesk& desk) { desk->lost_packets = 5; },
                    [](KinectOnDesk& desk) { desk->lost_packets = 0; }, "sensor-silent"};

INSTANTIATE_TEST_SUITE_P(Each, KinectFaults, ::testing::Values(silent, unplugged, damaged));

}  // namespace
}  // namespace octurn
