#pragma once

#include <array>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <stop_token>
#include <string>
#include <vector>

#include "kinect/camera_commands.hpp"
#include "kinect/depth_table.hpp"
#include "kinect/packet_frames.hpp"
#include "kinect/usb_device.hpp"
#include "rig/packet_counts.hpp"
#include "rig/tilt.hpp"
#include "rig/usb_log.hpp"

namespace octurn {

/// A frame of 640 x 480 raw readings, `lost_reading` where its packet was lost, and the arrival of
/// its first packet. The exposure ended before that.
struct RawFrame {
  std::span<const std::uint16_t> readings = {};
  std::chrono::steady_clock::time_point time = {};
};

/// A Kinect v1 on USB. Its colour camera is never started: a Raspberry Pi has no bandwidth for
/// both. Its audio part is left alone: a reset, which models 1473 and for Windows need before their
/// accelerometer answers, makes some of them vanish.
class Kinect {
 public:
  /// Takes at most 5 s.
  /// @param index  among the Kinects that are plugged in
  /// @throws Error "sensor-missing"; "sensor-failed" if it does not answer
  explicit Kinect(int index);
  Kinect(const Kinect&) = delete;
  Kinect& operator=(const Kinect&) = delete;

  /// The number of Kinects that are plugged in.
  static int count();

  /// Identifies this Kinect among others: the serial number of its camera or, if that has none, of
  /// its microphones; else its USB port.
  const std::string& serial() const { return serial_; }

  const KinectParameters& parameters() const { return parameters_; }

  /// Asks its accelerometer for the tilt; takes at most 500 ms. Nothing if the model has no
  /// accelerometer that can be read, or it does not answer.
  std::optional<Tilt> tilt();

  bool has_near_mode() const { return has_near_mode_; }

  /// @return false if the depth stream runs, which does not allow a change, or the device refuses
  bool set_near_mode(bool on);

  /// Runs the depth stream until a stop is requested or the device is gone; then returns within 2
  /// s.
  /// @param on_frame  receives each frame of which at least 80 % of the packets arrived
  void stream(const std::stop_token& stop, const std::function<void(const RawFrame&)>& on_frame);

  PacketCounts packet_counts() const;

  /// Logs the stream's next packets, at most `count`, and forgets an earlier log.
  void log_packets(std::size_t count);

  /// Takes packets from the log, the oldest first, as many as fit. @return their number
  std::size_t take_logged(std::span<UsbPacket> packets);

  /// Whether it was unplugged, or hangs.
  bool is_lost() const { return is_lost_; }

 private:
  void start_depth();
  bool count_packets(const ReceivedFrame& frame);
  void log(const IsoPacket& packet);

  std::mutex usb_;  // guards camera_ and commands_; held while a stream runs
  std::unique_ptr<UsbDevice> camera_;
  CameraCommands commands_;
  std::mutex motor_mutex_;            // guards motor_
  std::unique_ptr<UsbDevice> motor_;  // null if it cannot be asked
  std::string serial_ = {};
  KinectParameters parameters_ = {};
  bool has_near_mode_ = false;
  std::atomic<bool> is_lost_ = false;
  mutable std::mutex counts_mutex_;  // guards counts_
  PacketCounts counts_ = {};
  std::mutex log_mutex_;  // guards log_ and log_room_
  std::vector<UsbPacket> log_ = {};
  std::size_t log_room_ = 0;  // packets that are still to be logged
};

}  // namespace octurn
