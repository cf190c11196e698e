#include <gtest/gtest.h>

#include <chrono>
#include <filesystem>
#include <string>
#include <vector>

#include "support/daemon.hpp"
#include "support/stl.hpp"

// Models that are not files: the preview of a running scan, and models built while they are
// downloaded.

namespace octurn {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using namespace std::chrono_literals;

TEST(Preview, ShowsWhatAScanHasSeenSoFar) {
  const TemporaryFolder folder;
  const Daemon daemon(folder.path());
  const std::string scan = daemon.start(endless);
  daemon.wait_until(scan, [](const json& now) { return now["snapshots_done"] >= 1; });
  const auto preview_with = [&](std::int64_t more_than) {
    Reply reply;
    const auto deadline = std::chrono::steady_clock::now() + patience;
    do {
      reply = daemon.get(scan + "/preview.stl");
    } while ((reply.status != 200 || triangles_of_whole_stl(reply.body) <= more_than) &&
             std::chrono::steady_clock::now() < deadline);
    return reply;
  };
  const Reply first = preview_with(100);
  EXPECT_EQ(first.header("Content-Type"), "model/stl");
  EXPECT_GT(open_edges(first.body), 0);  // open where nothing was seen yet
  const Reply later = preview_with(triangles_of_whole_stl(first.body));
  EXPECT_GT(triangles_of_whole_stl(later.body), triangles_of_whole_stl(first.body));
  EXPECT_LE(triangles_of_whole_stl(later.body), 60'000);
  EXPECT_GT(open_edges(later.body), 0);
  EXPECT_NE(later.header("ETag"), first.header("ETag"));

  const json running = parsed(daemon.get(scan));
  EXPECT_EQ(running["preview"]["url"], scan + "/preview.stl");
  EXPECT_GE(running["preview"]["snapshots"], 1);

  daemon.post(scan + "/cancel", "");
  EXPECT_EQ(daemon.wait_until_done(scan)["preview"], nullptr);
  daemon.wait_until_done(daemon.start(quick));
  EXPECT_EQ(parsed(daemon.get(scan + "/preview.stl"))["code"], "no-preview");
}

const std::string quick_shell =
    R"({"snapshots": 3, "frames": 2, "leaf_size_mm": 4, "method": "intersection"})";

TEST(ModelStream, IsMadeWhileItIsDownloaded) {
  const TemporaryFolder folder;
  const Daemon daemon(folder.path());
  const std::string scan = daemon.start(quick_shell);
  const json done = daemon.wait_until_done(scan);
  ASSERT_EQ(done["state"], "finished");
  const fs::path stored = folder.path() / "data" / "scans" / done["id"];
  const fs::path expected = folder.path() / "expected.stl";
  struct Way {
    std::string query;
    std::vector<std::string> options;  // the same for the command, which has no scan settings
  };
  const std::vector<Way> ways{
      {"leaf_size_mm=2", {"--leaf-size-mm", "2"}},
      {"level=7", {"--leaf-size-mm", "4", "--level", "7"}},
      {"leaf_size_mm=1&level=9", {"--leaf-size-mm", "1", "--level", "9"}},
      {"leaf_size_mm=%32", {"--leaf-size-mm", "2"}},  // RFC 3986, 6.2.2.2: %32 is 2
  };
  for (const auto& [query, options] : ways) {
    std::vector<std::string> command{octurn_program(), "reconstruct", stored,        "-o",
                                     expected,         "--method",    "intersection"};
    command.insert(command.end(), options.begin(), options.end());
    Program reconstruct(command);
    ASSERT_EQ(reconstruct.wait(), 0) << reconstruct.errors();
    const Reply made = daemon.get(scan + "/Scan.stl?" + query);
    EXPECT_EQ(made.status, 200) << made.body;
    EXPECT_EQ(made.header("Content-Type"), "model/stl");
    EXPECT_EQ(made.header("Content-Length"), std::to_string(made.body.size()));
    EXPECT_TRUE(made.body == content_of(expected)) << query;
  }
  const Reply head = request(daemon.port(), "HEAD", scan + "/Scan.stl?leaf_size_mm=2");
  EXPECT_EQ(head.status, 200);
  EXPECT_GT(std::stoull(head.header("Content-Length")), 84U);
  EXPECT_EQ(head.body, "");
  EXPECT_EQ(std::distance(fs::directory_iterator(stored), {}), 4);  // job, scan, snapshots, model
}

TEST(ModelStream, RefusesParametersThatAreWrong) {
  const TemporaryFolder folder;
  const Daemon daemon(folder.path());
  const std::string scan = daemon.start(quick_shell);
  ASSERT_EQ(daemon.wait_until_done(scan)["state"], "finished");
  for (const char* const query :
       {"leaf_size_mm", "leaf_size_mm=", "leaf_size_mm=fine", "leaf_size_mm=0", "leaf_size_mm=-1",
        "leaf_size_mm=1&leaf_size_mm=2", "leaf_size_mm=1e999", "leaf_size_mm=inf",
        "leaf_size_mm=[1]", "leaf_size_mm=1%20", "level=99", "level=1.5", "level=-1", "snapshots=3",
        "leaf=1", "&"}) {
    const Reply reply = daemon.get(scan + "/Scan.stl?" + query);
    EXPECT_EQ(reply.status, 400) << query;
    EXPECT_EQ(parsed(reply)["code"], "bad-settings") << query;
  }
  EXPECT_EQ(daemon.get(scan + "/Scan.stl?leaf_size_mm=4").status, 200);
}

/// Starts the download of a model of hundreds of megabytes without reading it from the socket.
FileDescriptor begin_download(const Daemon& daemon, const std::string& scan) {
  FileDescriptor socket = connected(daemon.port());
  send_text(socket,
            "GET " + scan + "/Scan.stl?leaf_size_mm=0.2 HTTP/1.1\r\nHost: localhost\r\n\r\n");
  char letter = 0;
  EXPECT_EQ(::recv(socket.number(), &letter, 1, MSG_PEEK), 1);  // counted; the body begins
  return socket;
}

TEST(ModelStream, IsOneAtATimeAndNoneDuringAScan) {
  const TemporaryFolder folder;
  const Daemon daemon(folder.path());
  const std::string scan = daemon.start(quick_shell);
  ASSERT_EQ(daemon.wait_until_done(scan)["state"], "finished");
  const auto wanted = [&] { return daemon.get(scan + "/Scan.stl?leaf_size_mm=4"); };
  {
    const FileDescriptor download = begin_download(daemon, scan);
    const Reply refused = wanted();
    EXPECT_EQ(refused.status, 409);
    EXPECT_EQ(parsed(refused)["code"], "busy");
  }
  // When the client is gone, the build ends, and another one is possible.
  const auto deadline = std::chrono::steady_clock::now() + patience;
  Reply again = wanted();
  while (again.status == 409 && std::chrono::steady_clock::now() < deadline) {
    again = wanted();
  }
  EXPECT_EQ(again.status, 200);

  const std::string other = daemon.start(endless);
  EXPECT_EQ(wanted().status, 409);
  daemon.post(other + "/cancel", "");
  daemon.wait_until_done(other);
  EXPECT_EQ(wanted().status, 200);
}

TEST(ModelStream, EndsForAScanThatStarts) {
  const TemporaryFolder folder;
  const Daemon daemon(folder.path());
  const std::string scan = daemon.start(quick_shell);
  ASSERT_EQ(daemon.wait_until_done(scan)["state"], "finished");
  const FileDescriptor download = begin_download(daemon, scan);
  const std::string other = daemon.start(quick_shell);
  const Reply cut = reply_from(receive_all(download));
  EXPECT_LT(cut.body.size(), std::stoull(cut.header("Content-Length")));
  EXPECT_EQ(daemon.wait_until_done(other)["state"], "finished");
}

}  // namespace
}  // namespace octurn
