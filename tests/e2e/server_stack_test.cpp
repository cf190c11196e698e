#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdio>
#include <sstream>
#include <string>
#include <string_view>

#include "support/daemon.hpp"
#include "support/http_client.hpp"
#include "support/temporary_folder.hpp"

namespace octurn {
namespace {

#ifndef __has_feature  // clang's; GCC defines macros
#define __has_feature(feature) 0
#endif

constexpr std::size_t server_stack = std::size_t{100} * 1024;  // bytes per thread
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__) || \
    __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
constexpr std::size_t max_touched = server_stack;  // sanitizers make frames larger
#else
constexpr std::size_t max_touched = server_stack * 3 / 4;
#endif

/// The most bytes ever touched in the stack of a server thread. The stacks are the mappings whose
/// size is civetweb's stack size, 100 KiB in Debian's build.
std::size_t max_touched_stack(int process) {
  std::istringstream maps(content_of("/proc/" + std::to_string(process) + "/smaps"));
  std::size_t mapped = 0;
  std::size_t touched = 0;
  for (std::string line; std::getline(maps, line);) {
    unsigned long begin = 0;
    unsigned long end = 0;
    std::array<char, 5> rights{};
    unsigned long resident = 0;  // KiB
    if (std::sscanf(line.c_str(), "%lx-%lx %4s", &begin, &end, rights.data()) == 3) {
      mapped = std::string_view(rights.data()) == "rw-p" ? end - begin : 0;
    } else if (mapped == server_stack && std::sscanf(line.c_str(), "Rss: %lu", &resident) == 1) {
      touched = std::max(touched, resident * 1024);
    }
  }
  return touched;
}

TEST(ServerStack, IsUsedByThreeQuartersAtMost) {
  const TemporaryFolder folder;
  Daemon daemon(folder.path());
  const std::string scan = daemon.start(quick);
  ASSERT_EQ(daemon.wait_until_done(scan)["state"], "finished");
  const std::string nested = std::string(30'000, '[') + std::string(30'000, ']');
  for (int i = 0; i < 40; ++i) {  // so that each thread handles some of the requests
    for (const std::string& path :
         {scan, scan + "/Scan.stl", scan + "/Scan.stl?leaf_size_mm=8", scan + "/preview.stl",
          std::string("/api/v1/scans"), std::string("/api/v1/status"), std::string("/nothing"),
          std::string("/")}) {
      daemon.get(path);
    }
    daemon.post("/api/v1/scans", nested);
    request(daemon.port(), "PATCH", scan, R"({"name": "Hase"})");
  }
  for (const char* const path :
       {"/api/v1/doctor", "/api/v1/diagnostics.zip", "/api/v1/preview/depth.png"}) {
    EXPECT_EQ(daemon.get(path).status, 200);
  }
  const std::size_t touched = max_touched_stack(daemon.program().process());
  EXPECT_GT(touched, 0U);
  EXPECT_LE(touched, max_touched);
}

}  // namespace
}  // namespace octurn
