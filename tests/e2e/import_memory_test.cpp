#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>
#include <thread>
#include <vector>

#include "octurn/sensor_map.hpp"
#include "support/archive.hpp"
#include "support/daemon.hpp"
#include "support/temporary_folder.hpp"

// The check of an archive from outside takes little memory, whatever is in it.

namespace octurn {
namespace {

constexpr std::size_t mib = std::size_t{1} << 20U;

/// `[[],[],...]`, of that many bytes.
std::string empty_arrays(std::size_t bytes) {
  std::string text = "[[]";
  while (text.size() + 4 < bytes) {
    text += ",[]";
  }
  return text + "]";
}

/// A scan whose images can be read, but which is refused after that: its clip box is too large.
std::vector<ArchivedFile> refused_at_last(int width, int height) {
  std::vector<ArchivedFile> files = scan_files_of(1, width, height);
  nlohmann::json scan = scan_json_of(1, width, height);
  scan["clip_m"]["max"] = {1e5, 1e5, 1e5};
  files.front().content = scan.dump();
  return files;
}

std::string sensor_map(int width, int height) {
  const std::vector<float> plane(static_cast<std::size_t>(width) *
                                 static_cast<std::size_t>(height));
  return text_of(encode_sensor_map({.width = width,
                                    .height = height,
                                    .near_inverse_depth = 2,
                                    .far_inverse_depth = 1,
                                    .near = plane,
                                    .far = plane}));
}

/// Archives that took a gigabyte, or would take all that the limits allow.
std::vector<std::string> large_archives() {
  std::vector<std::vector<ArchivedFile>> all;
  all.push_back({{"scan.json", R"({"snapshots": )" + empty_arrays(15 * mib) + "}"}});
  all.push_back({{"scan.json", R"({"snapshots": )" + empty_arrays(600'000) + "}"}});
  all.push_back(scan_files_of(1, 8192, 8192));
  all.push_back(refused_at_last(4096, 3072));
  all.push_back(refused_at_last(2048, 2048));
  all.back().push_back({"sensor-map.png", sensor_map(2048, 2048)});
  all.push_back(refused_at_last(640, 480));
  all.back().push_back({"sensor-map.png", sensor_map(4096, 4096)});
  all.push_back(refused_at_last(640, 480));
  all.back().push_back({"job.json", R"({"snapshots": )" + empty_arrays(1'000'000) + "}"});
  std::vector<std::string> archives;
  for (const std::vector<ArchivedFile>& files : all) {
    archives.push_back(make_zip(files, {}));
  }
  return archives;
}

TEST(Memory, OfAnImportIsBounded) {
  const TemporaryFolder folder;
  const Daemon daemon(folder.path());
  const std::vector<std::string> archives = large_archives();
  EXPECT_EQ(daemon.get("/api/v1/scans").status, 200);
  const std::size_t before = daemon.peak_memory();
  const auto import = [&](const std::string& archive) {
    const Reply reply = reply_to(
        daemon.port(),
        "POST /api/v1/scans/import HTTP/1.1\r\nHost: localhost:" + std::to_string(daemon.port()) +
            "\r\nContent-Type: application/octet-stream\r\nContent-Length: " +
            std::to_string(archive.size()) + "\r\n\r\n" + archive);
    EXPECT_TRUE(reply.status == 400 || reply.status == 503) << reply.body;
  };
  for (const std::string& archive : archives) {
    import(archive);
    EXPECT_LT(daemon.peak_memory(), before + 100 * mib) << archive.size();
    std::vector<std::jthread> others;
    for (int i = 0; i < 3; ++i) {
      others.emplace_back([&] { import(archive); });
    }
  }
  EXPECT_LT(daemon.peak_memory(), before + 100 * mib);
}

}  // namespace
}  // namespace octurn
