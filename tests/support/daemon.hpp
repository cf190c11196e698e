#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "support/http_client.hpp"
#include "support/patience.hpp"
#include "support/program.hpp"
#include "support/temporary_folder.hpp"

namespace octurn {

inline nlohmann::json parsed(const Reply& reply) {
  return nlohmann::json::parse(reply.body, nullptr, false);
}

/// `octurn serve` on the simulated rig, with a sensor of the data sheet's optics, much faster than
/// real time unless `more` has another --simulate-speed, on a free local port.
class Daemon {
 public:
  explicit Daemon(const std::filesystem::path& folder, std::vector<std::string> more = {},
                  const ProgramLimits& limits = {})
      : Daemon(command(folder, std::move(more)), limits) {}
  explicit Daemon(std::vector<std::string> command, const ProgramLimits& limits = {})
      : program_(std::move(command), limits) {
    const std::string line = program_.read_line();  // "Octurn is at http://127.0.0.1:41234/"
    const std::size_t colon = line.rfind(':');
    port_ = colon == std::string::npos ? 0 : std::stoi(line.substr(colon + 1));
    EXPECT_GT(port_, 0) << line;
  }

  static std::vector<std::string> command(const std::filesystem::path& folder,
                                          std::vector<std::string> more = {}, int port = 0) {
    put(folder / "web" / "index.html", "<!doctype html><title>Octurn</title>");
    std::vector<std::string> words{octurn_program(), "serve", "--simulate", "--simulate-unit", "0"};
    if (std::ranges::find(more, "--simulate-speed") == more.end()) {
      words.insert(words.end(), {"--simulate-speed", "20"});
    }
    words.insert(words.end(), {"--listen", "127.0.0.1", "--port", std::to_string(port), "--data",
                               folder / "data", "--web", folder / "web"});
    words.insert(words.end(), more.begin(), more.end());
    return words;
  }

  int port() const { return port_; }
  Program& program() { return program_; }

  /// Peak resident memory so far, bytes.
  std::size_t peak_memory() const {
    const std::string status =
        content_of("/proc/" + std::to_string(program_.process()) + "/status");
    return std::stoul(status.substr(status.find("VmHWM:") + 6)) * 1024;
  }

  Reply get(const std::string& path, const Headers& headers = {}) const {
    return request(port_, "GET", path, "", headers);
  }
  Reply post(const std::string& path, const std::string& body = "{}") const {
    return request(port_, "POST", path, body);
  }
  nlohmann::json status() const { return parsed(get("/api/v1/status")); }

  /// Starts a scan. @return its path
  std::string start(const std::string& settings) const {
    const Reply reply = post("/api/v1/scans", settings);
    EXPECT_EQ(reply.status, 202) << reply.body;
    return reply.header("Location");
  }

  /// Waits until a scan is as wanted, at most for `patience`. @return the scan's last state
  nlohmann::json wait_until(const std::string& scan,
                            const std::function<bool(const nlohmann::json&)>& wanted) const {
    const auto deadline = std::chrono::steady_clock::now() + patience;
    nlohmann::json now = parsed(get(scan));
    while (!wanted(now) && std::chrono::steady_clock::now() < deadline) {
      std::this_thread::yield();
      now = parsed(get(scan));
    }
    return now;
  }
  nlohmann::json wait_until_done(const std::string& scan) const {
    return wait_until(scan, [](const nlohmann::json& now) { return now["state"] != "running"; });
  }

 private:
  Program program_;
  int port_ = 0;
};

/// The state of a scan in its folder. @param data  folder of the daemon's  @param scan  its path
inline std::string stored_state(const std::filesystem::path& data, const std::string& scan) {
  const std::filesystem::path id = std::filesystem::path(scan).filename();
  return nlohmann::json::parse(content_of(data / "scans" / id / "job.json"))["state"];
}

inline const std::string quick = R"({"snapshots": 3, "frames": 2, "leaf_size_mm": 4})";
inline const std::string endless = R"({"snapshots": 400, "frames": 2, "leaf_size_mm": 4})";

}  // namespace octurn
