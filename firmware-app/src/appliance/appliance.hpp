#pragma once

#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <mutex>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "appliance/wifi.hpp"
#include "octurn/file.hpp"

namespace octurn {

/// How the running system is to end.
enum class PowerEnd { restart, off };

/// A request that root carries out at once: restart, power off, or a new time of the clock.
using ControlRequest = std::variant<PowerEnd, std::chrono::sys_seconds>;

/// Reads the time of a body, `{"unix_s": 1795824000}`: Unix time in seconds, from 2026 to 2100.
/// @throws Error "bad-settings"
std::chrono::sys_seconds clock_from(const nlohmann::json& body);

/// The line that root reads: "restart", "off" or "clock 1764012345".
std::string to_text(const ControlRequest& request);

/// The machine's name and time zone, as root reports them.
struct MachineState {
  std::string name = {};       ///< the page is at http://NAME.local
  std::string time_zone = {};  ///< "Europe/Berlin"; empty: UTC
  std::string error = {};      ///< what is wrong with the last request, or empty
};

/// A change of the name, the time zone or both.
struct MachineRequest {
  std::optional<std::string> name = {};
  std::optional<std::string> time_zone = {};
};

/// Reads {"name", "time_zone"}.
/// @throws Error "bad-settings"  that names the key; also if the body has neither
MachineRequest machine_request_from(const nlohmann::json& body);

/// The request as lines of octurn.txt.
std::string to_text(const MachineRequest& request);

/// State of an update of the image.
struct UpdateState {
  std::string slot = {};  ///< the running system, "a" or "b"; empty: not known yet
  /// "none", "receiving" by this program, "installing", "restarting", "failed", "trial", "kept" or
  /// "returned"
  std::string state = "none";
  std::string version = {};  ///< of the update; empty: not known
  std::string error = {};    ///< what is wrong and what to do, or empty
};

struct WifiState {
  std::string state = "none";  ///< or "joining", "joined", "failed", "hotspot"
  std::string name = {};       ///< of the WiFi to join, or empty
  std::string country = {};    ///< two letters, or empty
  std::string hotspot = {};    ///< the name of the scanner's own WiFi while that is on, or empty
  std::string error = {};      ///< what is wrong and what to do, or empty
  std::vector<WifiNetwork> networks = {};
};

/// Versions of an update that root accepts: those not older than the running system, or any.
enum class UpdateAge : std::uint8_t { not_older, any };

/// Interface to the root services of Octurn's image. This program is not root: it writes requests
/// into a folder, root carries them out and writes answers beside them. Thread-safe.
class Appliance {
 public:
  /// Removes unfinished requests of an earlier process.
  /// @param folder  with the answers; the requests are in its subfolder `requests`
  explicit Appliance(std::filesystem::path folder);
  ~Appliance() = default;
  Appliance(const Appliance&) = delete;
  Appliance& operator=(const Appliance&) = delete;

  UpdateState update() const;
  WifiState wifi() const;

  /// Errors that root has logged in this boot and earlier ones, newest last. Of a long log only the
  /// end.
  std::string errors() const;

  /// Whether an update is being received or installed: the machine may restart at any moment.
  bool is_updating() const;

  MachineState machine() const;

  /// Asks root to change the host name or the time zone.
  /// @throws Error  if the request cannot be written
  void ask_for_machine(const MachineRequest& request);

  /// Asks root to restart this machine, shut it down or set its clock.
  /// @throws Error  if the request cannot be written
  void ask_for_control(const ControlRequest& control);

  /// Asks root to join a WiFi. @throws Error  if the request cannot be written
  void ask_for_wifi(const WifiRequest& request);

  /// An update that is being received, one at a time. Root gets it whole or not at all.
  class Upload {
   public:
    static constexpr std::uint64_t max_bytes = std::uint64_t{160} << 20U;

    /// @throws Error "busy", "too-large", "no-space"
    Upload(Appliance& appliance, std::uint64_t bytes, UpdateAge age);

    /// @throws Error "no-space"
    void write(std::span<const std::byte> bytes);
    void commit();

   private:
    /// Holds the flag `is_receiving_` during its lifetime.
    class Turn {
     public:
      explicit Turn(std::atomic<bool>& is_taken);
      ~Turn() { is_taken_ = false; }
      Turn(const Turn&) = delete;
      Turn& operator=(const Turn&) = delete;

     private:
      std::atomic<bool>& is_taken_;
    };

    Turn turn_;
    AtomicFile file_;
    std::filesystem::path older_;  // marker file by which root accepts an older version
    UpdateAge age_;
  };

 private:
  std::filesystem::path request(std::string_view name) const;
  struct Asked {
    WifiRequest wifi = {};
    std::filesystem::file_time_type time = {};
    std::chrono::steady_clock::time_point until = {};
  };

  UpdateState answered_update() const;
  std::optional<WifiRequest> unanswered_wifi() const;
  std::filesystem::path place_for_update(std::uint64_t bytes) const;

  std::filesystem::path folder_;
  std::atomic<bool> is_receiving_ = false;  // true while an Upload exists
  mutable std::mutex mutex_;                // guards asked_
  std::optional<Asked> asked_ = {};         // the last request for a WiFi
};

}  // namespace octurn
