#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "support/daemon.hpp"
#include "support/program.hpp"
#include "support/temporary_folder.hpp"
#include "support/zip.hpp"
#include "version.hpp"

namespace octurn {
namespace {

using nlohmann::json;

constexpr const char* path = "/api/v1/diagnostics.zip";

TEST(Diagnostics, AreAFileThatTellsOfTheDaemon) {
  const TemporaryFolder folder;
  const Daemon daemon(folder.path());
  const std::string scan = daemon.start(quick);
  daemon.wait_until_done(scan);
  request(daemon.port(), "PATCH", scan, R"({"name": "Mein Hase"})");

  const Reply reply = daemon.get(path);
  EXPECT_EQ(reply.status, 200);
  EXPECT_EQ(reply.header("Content-Type"), "application/zip");
  EXPECT_EQ(reply.header("Cache-Control"), "no-store");
  EXPECT_TRUE(reply.header("Content-Disposition")
                  .starts_with("attachment; filename=\"octurn-diagnostics-20"))
      << reply.header("Content-Disposition");
  EXPECT_LT(reply.body.size(), 4U << 20U);

  const std::vector<ArchivedFile> files = unzipped(reply.body);
  ASSERT_EQ(files.size(), 8U);
  EXPECT_EQ(json_in(files, "versions.json")["octurn"], version());
  EXPECT_EQ(json_in(files, "settings.json")["data"], (folder.path() / "data").string());
  EXPECT_EQ(json_in(files, "doctor.json")["findings"][0]["state"], "ok");
  EXPECT_TRUE(json_in(files, "calibration.json")["optics"].is_array());
  EXPECT_EQ(json_in(files, "devices.json")["sensor"]["state"], "ready");
  EXPECT_EQ(json_in(files, "scans.json")["scans"][0]["state"], "finished");
  EXPECT_NE(content_in(files, "log.txt").find(scan.substr(scan.rfind('/') + 1) + " finished"),
            std::string::npos);
  EXPECT_NE(content_in(files, "system.txt").find("==> /proc/meminfo <==\nMemTotal:"),
            std::string::npos);
  for (const ArchivedFile& file : files) {
    EXPECT_EQ(file.content.find("Hase"), std::string::npos) << file.name;
  }
}

TEST(Diagnostics, AnswerHeadWithoutABody) {
  const TemporaryFolder folder;
  const Daemon daemon(folder.path());
  const Reply head = request(daemon.port(), "HEAD", path);
  EXPECT_EQ(head.status, 200);
  EXPECT_EQ(head.header("Content-Type"), "application/zip");
  EXPECT_GT(std::stoi(head.header("Content-Length")), 1000);
  EXPECT_EQ(head.body, "");
  EXPECT_EQ(request(daemon.port(), "DELETE", path).header("Allow"), "GET, HEAD");
}

TEST(Diagnostics, AreNotForOtherHosts) {
  const TemporaryFolder folder;
  const Daemon daemon(folder.path());
  const std::string rebound =
      std::string("GET ") + path + " HTTP/1.1\r\nHost: evil.example\r\n\r\n";
  EXPECT_EQ(reply_to(daemon.port(), rebound).status, 421);
}

TEST(Diagnostics, LeaveAScanAlone) {
  const TemporaryFolder folder;
  const Daemon daemon(folder.path());
  const std::string scan = daemon.start(endless);
  const std::vector<ArchivedFile> files = unzipped(daemon.get(path).body);
  const json sensor = json_in(files, "doctor.json")["findings"][0];
  EXPECT_EQ(sensor["check"], "sensor");
  EXPECT_EQ(sensor["state"], "unknown") << sensor;
  EXPECT_EQ(json_in(files, "scans.json")["scans"][0]["state"], "running");
  EXPECT_EQ(parsed(daemon.get(scan))["state"], "running");
}

TEST(Diagnostics, AreWrittenByTheShellToo) {
  const TemporaryFolder folder;
  const std::filesystem::path file = folder.path() / "diagnostics.zip";
  Program doctor(
      {octurn_program(), "doctor", "--simulate", "--json", "--data", folder.path(), "--zip", file});
  doctor.wait();
  const std::vector<ArchivedFile> files = unzipped(content_of(file));
  ASSERT_EQ(files.size(), 6U);
  EXPECT_TRUE(json_in(files, "scans.json")["scans"].empty());
  EXPECT_EQ(json_in(files, "calibration.json")["poses"].size(), 1U);
  const json printed = json::parse(doctor.output(), nullptr, false);
  EXPECT_EQ(json_in(files, "doctor.json")["findings"], printed["findings"]);
}

}  // namespace
}  // namespace octurn
