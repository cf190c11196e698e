#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "kinect/depth_table.hpp"

namespace octurn {

/// The control endpoint of the Kinect's camera. Both functions return the bytes transferred, or a
/// negative number where the transfer failed, or took too long, and may be tried again. They throw
/// if the device is gone.
struct ControlEndpoint {
  using Timeout = std::chrono::milliseconds;  ///< more than 0
  std::function<int(std::span<const std::uint8_t>, Timeout)> write = {};
  std::function<int(std::span<std::uint8_t>, Timeout)> read = {};
};

/// The commands of the Kinect's camera. Its firmware is slow: it answers a request for its reply by
/// nothing until the reply is ready, and sometimes by one that is stale or cut. Such answers,
/// stalls and timeouts are survived: the reply is asked for again, or the command is sent again.
/// All commands here can be repeated without harm.
class CameraCommands {
 public:
  using Clock = std::chrono::steady_clock;

  explicit CameraCommands(ControlEndpoint endpoint) : endpoint_(std::move(endpoint)) {}

  /// Reads what the factory wrote into the camera.
  /// @throws Error "sensor-failed"  if there is no valid reply before the deadline, or its
  ///                                parameters make no sense
  KinectParameters parameters(Clock::time_point deadline);

  /// @throws Error "sensor-failed"  if there is no valid reply before the deadline
  void write_register(std::uint16_t address, std::uint16_t value, Clock::time_point deadline);

 private:
  std::vector<std::uint8_t> send(std::uint16_t command, std::span<const std::uint16_t> words,
                                 std::size_t reply_bytes, Clock::time_point deadline);
  std::optional<std::vector<std::uint8_t>> reply_to(std::span<const std::uint8_t> message,
                                                    Clock::time_point deadline);

  ControlEndpoint endpoint_;
  std::uint16_t tag_ = 0;  // of the last command: its reply repeats it
};

}  // namespace octurn
