// Export of a scan as an archive, and its import by another Octurn.

#include "store/scan_archive.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <thread>

#include "support/archive.hpp"
#include "support/daemon.hpp"
#include "support/http_client.hpp"
#include "support/patience.hpp"
#include "support/room_scan.hpp"
#include "support/temporary_folder.hpp"
#include "zip_file.hpp"

namespace octurn {
namespace {

using nlohmann::json;

Reply import(const Daemon& daemon, const std::string& archive) {
  return reply_to(
      daemon.port(),
      "POST /api/v1/scans/import HTTP/1.1\r\nHost: localhost:" + std::to_string(daemon.port()) +
          "\r\nContent-Type: application/octet-stream\r\nContent-Length: " +
          std::to_string(archive.size()) + "\r\n\r\n" + archive);
}

TEST(ScanArchive, MakesTheSameModelOnAnotherOcturn) {
  const TemporaryFolder here;
  const TemporaryFolder there;
  const Daemon first(here.path());
  const std::string scan = first.start(
      R"({"snapshots": 4, "leaf_size_mm": 6, "filter": "basic", "clip_mm": [-90, -90, 5, 90, 90, 300]})");
  ASSERT_EQ(first.wait_until_done(scan)["state"], "finished");
  request(first.port(), "PATCH", scan, R"({"name": "Möwe"})");
  const Reply archive = first.get(scan + "/scan.zip");
  ASSERT_EQ(archive.status, 200);
  EXPECT_EQ(archive.header("Content-Type"), "application/zip");
  EXPECT_TRUE(first.get(scan + "/scan.zip").body == archive.body) << "the same bytes again";

  // Where the data folder takes no archive, as on a full disk, another one does.
  const std::string id = scan.substr(scan.rfind('/') + 1);
  std::filesystem::create_directories(here.path() / "data" / "scans" / (".export-" + id + ".zip") /
                                      "taken");
  EXPECT_TRUE(first.get(scan + "/scan.zip").body == archive.body);

  const Daemon second(there.path(), {"--sensor", "nowhere"});  // it needs no rig
  const Reply imported = import(second, archive.body);
  ASSERT_EQ(imported.status, 201) << imported.body;
  const json done = second.wait_until_done(imported.header("Location"));
  EXPECT_EQ(done["state"], "finished") << done;
  EXPECT_EQ(done["name"], "Möwe");
  EXPECT_TRUE(second.get(imported.header("Location") + "/Scan.stl").body ==
              first.get(scan + "/Scan.stl").body);
}

TEST(ScanArchive, IsRefusedWholeIfItIsNoScan) {
  const TemporaryFolder folder;
  const Daemon daemon(folder.path());
  const auto zip = [](const std::string& name, const std::string& content) {
    const std::vector<ArchivedFile> files{{.name = name, .content = content}};
    return make_zip(files, {});
  };
  for (const std::string& archive :
       {std::string("nonsense"), std::string(), zip("../scan.json", "{}"), zip("/etc/passwd", "x"),
        zip("snapshots/../../x.png", "x"), zip("scan.json/", ""), zip("Scan.stl", "x"),
        zip("scan.json", "{}"), zip("scan.json", std::string(34'000'000, ' '))}) {
    const Reply reply = import(daemon, archive);
    EXPECT_EQ(reply.status, 400) << archive.substr(0, 60);
    EXPECT_EQ(reply.header("Content-Type"), "application/problem+json");
  }
  EXPECT_TRUE(parsed(daemon.get("/api/v1/scans"))["scans"].empty());
  EXPECT_TRUE(std::filesystem::is_empty(folder.path() / "data" / "scans"));
  EXPECT_EQ(daemon.post("/api/v1/scans/import", "{}").status, 415);
}

TEST(ScanArchive, WithFreePosesIsRefusedAndSaysWhatToDo) {
  const TemporaryFolder folder;
  write_room_scan(folder.path() / "room", small_room(), 2);
  write_scan_archive(folder.path() / "room", folder.path() / "scan.zip");
  const Daemon daemon(folder.path());

  const Reply reply = import(daemon, content_of(folder.path() / "scan.zip"));
  EXPECT_EQ(reply.status, 400);
  const json problem = parsed(reply);
  EXPECT_NE(problem["detail"].get<std::string>().find("free poses"), std::string::npos) << problem;
  EXPECT_NE(problem["hint"].get<std::string>().find("octurn reconstruct"), std::string::npos);
  EXPECT_TRUE(parsed(daemon.get("/api/v1/scans"))["scans"].empty());
  EXPECT_TRUE(std::filesystem::is_empty(folder.path() / "data" / "scans"));
}

TEST(ScanArchive, IsLeftWhenTheDaemonEnds) {
  const TemporaryFolder folder;
  Daemon daemon(folder.path());
  // 100 images of 12 megapixels take 20 s or more to check.
  const std::string archive = make_zip(scan_files_of(100, 4096, 3072), {});
  const std::jthread client([&] { import(daemon, archive); });
  const std::filesystem::path scans = folder.path() / "data" / "scans";
  const auto is_unpacked = [&] {
    return std::filesystem::exists(scans / ".new-import-0/snapshots/099.png");
  };
  const auto deadline = std::chrono::steady_clock::now() + patience;
  while (!is_unpacked() && std::chrono::steady_clock::now() < deadline) {
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  ASSERT_TRUE(is_unpacked());
  daemon.program().send_signal(SIGTERM);
  EXPECT_EQ(daemon.program().wait(), 0);
  EXPECT_TRUE(std::filesystem::is_empty(scans));
}

}  // namespace
}  // namespace octurn
