#include <gtest/gtest.h>
#include <sched.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <thread>

#include "support/daemon.hpp"
#include "support/patience.hpp"
#include "support/program.hpp"
#include "support/temporary_folder.hpp"
#include "version.hpp"

namespace octurn {
namespace {

using nlohmann::json;

/// The finding of a check; null if there is none.
json finding(const json& report, const char* check) {
  const auto found = std::ranges::find_if(report["findings"],
                                          [&](const json& one) { return one["check"] == check; });
  return found == report["findings"].end() ? json() : *found;
}

/// Expects every finding to have a measurement, and every fault and warning to have advice.
void expect_complete(const json& report) {
  EXPECT_GT(report["findings"].size(), 10);
  for (const json& one : report["findings"]) {
    EXPECT_NE(one["measured"], "") << one;
    EXPECT_EQ(one["name"].empty(), false) << one;
    if (one["state"] == "fault" || one["state"] == "warning") {
      EXPECT_NE(one["advice"], "") << one;
    }
  }
}

TEST(DoctorCommand, ChecksTheSimulatedRig) {
  const TemporaryFolder folder;
  Program doctor({octurn_program(), "doctor", "--simulate", "--simulate-unit", "0", "--json",
                  "--data", folder.path()});
  const int status = doctor.wait();
  const json report = json::parse(doctor.output(), nullptr, false);
  ASSERT_TRUE(report.is_object()) << doctor.output() << doctor.errors();
  expect_complete(report);
  EXPECT_EQ(status, report["state"] == "fault" ? 1 : 0);
  EXPECT_EQ(report["version"], version());
  EXPECT_EQ(finding(report, "sensor")["state"], "ok");
  EXPECT_EQ(finding(report, "sensor")["measured"], "Kinect v1 (simulated), 640 x 480");
  EXPECT_EQ(finding(report, "platform")["state"], "ok") << report;
  EXPECT_EQ(finding(report, "depth-noise")["state"], "ok") << report;
  EXPECT_EQ(finding(report, "turntable")["state"], "ok");
  EXPECT_EQ(finding(report, "data-folder")["state"], "ok");
  EXPECT_TRUE(finding(report, "usb").is_null());
}

TEST(DoctorCommand, SaysWhatIsMissingWhereNothingIsConnected) {
  const TemporaryFolder folder;
  Program doctor({octurn_program(), "doctor", "--data", folder.path(), "--sensor", "kinect://7"});
  EXPECT_EQ(doctor.wait(), 1);
  EXPECT_NE(doctor.output().find("fault    Sensor "), std::string::npos) << doctor.output();
  EXPECT_NE(doctor.output().find("power supply"), std::string::npos) << doctor.output();
  EXPECT_EQ(doctor.output().find('\033'), std::string::npos);  // no colours in a pipe
}

// The last column is aligned.
TEST(DoctorCommand, AlignsItsTable) {
  const TemporaryFolder folder;
  Program doctor({octurn_program(), "doctor", "--simulate", "--data", folder.path()});
  doctor.wait();
  std::istringstream lines(doctor.output());
  const std::size_t column = doctor.output().find("Kinect v1");
  int rows = 0;
  for (std::string line; std::getline(lines, line) && !line.empty(); ++rows) {
    ASSERT_GT(line.size(), column) << line;
    EXPECT_EQ(line.substr(column - 2, 2), "  ") << line;
    EXPECT_NE(line[column], ' ') << line;
  }
  EXPECT_GT(rows, 10);
}

/// Waits until a program leaves SIGINT to its own threads, as it does from the begin of `main` on.
void wait_until_it_takes_signals(const Program& program) {
  const std::string status = "/proc/" + std::to_string(program.process()) + "/status";
  const auto blocked = [&] {
    const std::string text = content_of(status);
    return std::stoull(text.substr(text.find("SigBlk:") + 7), nullptr, 16);
  };
  const auto deadline = std::chrono::steady_clock::now() + patience;
  while ((blocked() >> (SIGINT - 1)) % 2 == 0) {
    ASSERT_LT(std::chrono::steady_clock::now(), deadline);
    std::this_thread::yield();
  }
}

// At its begin, while it reads the sensor, and while it turns the platform.
TEST(DoctorCommand, EndsWithinThreeSecondsOfCtrlC) {
  using namespace std::chrono_literals;
  for (const auto delay : {0ms, 500ms, 1500ms, 8000ms}) {
    const TemporaryFolder folder;
    const std::filesystem::path archive = folder.path() / "diagnostics.zip";
    Program doctor({octurn_program(), "doctor", "--simulate", "--turn", "--zip", archive, "--data",
                    folder.path() / "data"});
    wait_until_it_takes_signals(doctor);
    std::this_thread::sleep_for(delay);
    const auto begin = std::chrono::steady_clock::now();
    doctor.send_signal(SIGINT);
    EXPECT_EQ(doctor.wait(), 1) << delay.count() << " ms";
    EXPECT_LT(std::chrono::steady_clock::now() - begin, 3s) << delay.count() << " ms";
    EXPECT_NE(doctor.errors().find("stopped before the end"), std::string::npos) << doctor.errors();
    EXPECT_EQ(doctor.output(), "");
    EXPECT_FALSE(std::filesystem::exists(archive));
  }
}

/// Waits until a thread of a program measures its wake-ups, which is the last thing that it does.
void wait_until_it_measures_wake_ups(const Program& program) {
  const auto measures = [](const std::filesystem::directory_entry& task) {
    const std::string thread = task.path().filename();
    std::string slack_ns;
    std::ifstream("/proc/" + thread + "/timerslack_ns") >> slack_ns;
    return slack_ns == "1" || ::sched_getscheduler(std::stoi(thread)) == SCHED_FIFO;
  };
  const auto deadline = std::chrono::steady_clock::now() + patience;
  const std::string tasks = "/proc/" + std::to_string(program.process()) + "/task";
  while (std::ranges::none_of(std::filesystem::directory_iterator(tasks), measures)) {
    ASSERT_LT(std::chrono::steady_clock::now(), deadline);
    std::this_thread::yield();
  }
}

TEST(DoctorCommand, ReportsNothingAfterCtrlCOnceTheSensorHasBeenRead) {
  const TemporaryFolder folder;
  Program doctor({octurn_program(), "doctor", "--sensor", "kinect://7", "--data", folder.path()});
  wait_until_it_measures_wake_ups(doctor);
  doctor.send_signal(SIGINT);
  EXPECT_EQ(doctor.wait(), 1);
  EXPECT_EQ(doctor.output(), "");
  EXPECT_NE(doctor.errors().find("stopped before the end"), std::string::npos) << doctor.errors();
}

TEST(DoctorCommand, LeavesTheDaemonsLinesAndSensorAlone) {
  const TemporaryFolder folder;
  const Daemon daemon(folder.path());
  Program doctor({octurn_program(), "doctor", "--json", "--data", folder.path() / "data"});
  doctor.wait();
  const json report = json::parse(doctor.output(), nullptr, false);
  EXPECT_EQ(finding(report, "sensor")["state"], "unknown") << report;
  EXPECT_NE(finding(report, "sensor")["advice"].get<std::string>().find("page"), std::string::npos);
}

TEST(DoctorApi, GivesTheSameChecks) {
  const TemporaryFolder folder;
  const Daemon daemon(folder.path());
  const Reply reply = daemon.get("/api/v1/doctor");
  EXPECT_EQ(reply.status, 200);
  EXPECT_EQ(reply.header("Content-Type"), "application/json");
  const json report = parsed(reply);
  expect_complete(report);
  EXPECT_EQ(finding(report, "sensor")["state"], "ok");
  Program doctor({octurn_program(), "doctor", "--simulate", "--json", "--data", folder.path()});
  doctor.wait();
  const json same = json::parse(doctor.output(), nullptr, false);
  EXPECT_TRUE(std::ranges::equal(
      report["findings"], same["findings"],
      [](const json& one, const json& other) { return one["check"] == other["check"]; }));
}

TEST(DoctorApi, DoesNotDisturbAScan) {
  const TemporaryFolder folder;
  const Daemon daemon(folder.path());
  const std::string scan = daemon.start(endless);
  daemon.wait_until(scan, [](const json& now) { return now["snapshots_done"] >= 1; });
  const json report = parsed(daemon.get("/api/v1/doctor"));
  EXPECT_EQ(finding(report, "sensor")["state"], "unknown");
  EXPECT_NE(finding(report, "sensor")["measured"].get<std::string>().find("a scan is running"),
            std::string::npos);
  EXPECT_EQ(finding(report, "frame-rate")["state"], "unknown");
  EXPECT_EQ(finding(report, "disk")["state"], "ok");
  EXPECT_EQ(parsed(daemon.get(scan))["state"], "running");
}

}  // namespace
}  // namespace octurn
