// What a daemon finds that starts after another one ended.

#include <gtest/gtest.h>
#include <signal.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "support/daemon.hpp"
#include "support/http_client.hpp"
#include "support/program.hpp"
#include "support/temporary_folder.hpp"

namespace octurn {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

bool has_two_snapshots(const json& scan) { return scan["snapshots_done"] >= 2; }

/// Ends a daemon by a signal while it scans.
/// @param status  that it ends with
/// @return the scan's address
std::string end_while_it_scans(const fs::path& folder, int signal, int status) {
  Daemon daemon(folder);
  const std::string scan = daemon.start(endless);
  daemon.wait_until(scan, has_two_snapshots);
  daemon.program().send_signal(signal);
  EXPECT_EQ(daemon.program().wait(), status);
  return scan;
}

/// A command without the simulated rig, whose sensor comes from an OpenNI2 driver like a device's.
std::vector<std::string> command_with_devices(const fs::path& folder) {
  std::vector<std::string> command = Daemon::command(folder);
  command.erase(std::ranges::find(command, "--simulate"), std::ranges::find(command, "--listen"));
  command.insert(command.end(), {"--sensor", "octurn-simulator://"});
  return command;
}

TEST(Serve, KeepsItsDevicesClosedAfterItWasKilledThreeTimesSoonAfterItsStart) {
  const TemporaryFolder folder;
  fs::create_directories(folder.path() / "data");
  const auto sees = [](const Daemon& daemon) {
    return daemon.get("/api/v1/preview/depth.png").status == 200;
  };
  for (int i = 0; i < 3; ++i) {
    Daemon daemon(command_with_devices(folder.path()));
    EXPECT_TRUE(sees(daemon)) << "start " << i;
    daemon.program().send_signal(SIGKILL);
    EXPECT_EQ(daemon.program().wait(), -SIGKILL);
  }
  {
    Daemon daemon(command_with_devices(folder.path()));
    EXPECT_FALSE(sees(daemon));
    const json status = daemon.status();
    EXPECT_EQ(status["sensor"]["state"], "missing");
    EXPECT_NE(status["warnings"].dump().find("safe-mode"), std::string::npos);
    EXPECT_EQ(daemon.get("/api/v1/scans").status, 200);
    daemon.program().send_signal(SIGTERM);
    EXPECT_EQ(daemon.program().wait(), 0);
  }
  EXPECT_TRUE(sees(Daemon(command_with_devices(folder.path()))));
}

TEST(Serve, StartsOnAFullDiskAfterAChangeOfTheSettings) {
  const TemporaryFolder folder;
  {
    Daemon daemon(folder.path());
    EXPECT_EQ(
        request(daemon.port(), "PATCH", "/api/v1/settings", R"({"scan": {"frames": 7}})").status,
        200);
    daemon.program().send_signal(SIGTERM);
    EXPECT_EQ(daemon.program().wait(), 0);
  }
  const fs::path last = folder.path() / "data" / "settings.last.json";
  for (int i = 0; i < 2; ++i) {
    Daemon daemon(folder.path(), {}, {.file_bytes = 0});  // no file can be written
    EXPECT_EQ(parsed(daemon.get("/api/v1/settings"))["defaults"]["frames"], 7);
    daemon.program().send_signal(SIGTERM);
    EXPECT_EQ(daemon.program().wait(), 0);
    EXPECT_NE(daemon.program().errors().find("not kept as the last good ones"), std::string::npos);
    fs::remove(last);
    fs::create_directory(last);
  }
}

TEST(Serve, FindsWhatAKilledDaemonLeftBehind) {
  const TemporaryFolder folder;
  const std::string scan = end_while_it_scans(folder.path(), SIGKILL, -SIGKILL);
  const Daemon daemon(folder.path());
  const json left = parsed(daemon.get(scan));
  EXPECT_EQ(left["state"], "interrupted");
  EXPECT_GE(left["snapshots_done"], 2);
  EXPECT_EQ(parsed(daemon.get("/api/v1/scans"))["scans"][0]["state"], "interrupted");
  Program reconstruct({octurn_program(), "reconstruct",
                       folder.path() / "data" / "scans" / left["id"], "-o",
                       folder.path() / "Scan.stl"});
  EXPECT_EQ(reconstruct.wait(), 0) << reconstruct.errors();
  EXPECT_EQ(daemon.wait_until_done(daemon.start(quick))["state"], "finished");
}

TEST(Serve, EndsBeforeItsScanAndKeepsTheSnapshots) {
  const TemporaryFolder folder;
  const std::string scan = end_while_it_scans(folder.path(), SIGTERM, 0);
  const json kept = parsed(Daemon(folder.path()).get(scan));
  EXPECT_EQ(kept["state"], "interrupted");
  EXPECT_GE(kept["snapshots_done"], 2);
  EXPECT_LT(kept["snapshots_done"], 200);
}

}  // namespace
}  // namespace octurn
