// Scans of the daemon during which its emulated Kinect fails.

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
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

class KinectFaults : public ::testing::TestWithParam<std::tuple<Fault, int>> {
 protected:
  static const Fault& fault() { return std::get<0>(GetParam()); }
  static int stop() { return std::get<1>(GetParam()); }

  /// Lets the Kinect fail after at least `snapshots` snapshots. @return the scan once it is as
  /// wanted
  json scan_until(const Daemon& daemon, const std::string& scan, int snapshots,
                  const std::function<bool(const json&)>& wanted) {
    daemon.wait_until(scan, [&](const json& now) { return now["snapshots_done"] >= snapshots; });
    fault().begin(desk_);
    return daemon.wait_until(scan, wanted);
  }

  KinectOnDesk desk_{{readings_of(simulated_frame())}};
};

TEST_P(KinectFaults, PauseAScanThatIsResumedWhenTheyAreMended) {
  const TemporaryFolder folder;
  const Daemon daemon(folder.path(), {"--sensor", "kinect://"});
  ASSERT_EQ(daemon.wait_until_done(daemon.start(settings))["state"], "finished");
  const std::string model = daemon.get("/Scan.stl").body;

  const std::string scan = daemon.start(settings);
  const json paused =
      scan_until(daemon, scan, stop(), [](const json& now) { return now["state"] != "running"; });
  ASSERT_EQ(paused["state"], "paused") << paused;
  EXPECT_EQ(paused["error"]["code"], fault().code);
  EXPECT_GE(paused["snapshots_done"], stop());
  EXPECT_EQ(daemon.post(scan + "/resume", "").status, 503);

  fault().end(desk_);
  const auto deadline = std::chrono::steady_clock::now() + patience;
  Reply resumed;
  while (resumed.status != 202 && std::chrono::steady_clock::now() < deadline) {
    resumed = daemon.post(scan + "/resume", "");
  }
  ASSERT_EQ(resumed.status, 202) << resumed.body;
  const json done = daemon.wait_until_done(scan);
  ASSERT_EQ(done["state"], "finished") << done;
  EXPECT_TRUE(daemon.get(scan + "/Scan.stl").body == model);
}

TEST_P(KinectFaults, ThatPassDoNotPauseAScan) {
  const TemporaryFolder folder;
  const Daemon daemon(folder.path(), {"--sensor", "kinect://"});
  const std::string scan = daemon.start(settings);
  const json trying = scan_until(daemon, scan, stop(), [](const json& now) {
    return now["error"] != nullptr || now["state"] != "running";
  });
  EXPECT_EQ(trying["state"], "running");
  EXPECT_EQ(trying["error"]["code"].get<std::string>().substr(0, 7), "sensor-");
  fault().end(desk_);
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

INSTANTIATE_TEST_SUITE_P(AtEachStop, KinectFaults,
                         ::testing::Combine(::testing::Values(silent, unplugged, damaged),
                                            ::testing::Range(0, 4)));

}  // namespace
}  // namespace octurn
