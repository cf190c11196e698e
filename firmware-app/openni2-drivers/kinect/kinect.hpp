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
#include "rig/kinect_device.hpp"
#include "rig/usb_log.hpp"

namespace octurn {

/// A register of the camera, and a value for it.
struct CameraRegister {
  std::uint16_t address = 0;
  std::uint16_t value = 0;
};

/// One of the streams of the Kinect's camera.
struct CameraStream {
  std::uint8_t endpoint = 0;
  PacketFormat packets = {};
  std::span<const CameraRegister> start = {};  ///< what starts it, in this order
  CameraRegister stop = {};
};

/// Depth: 640 x 480, 30 Hz, 11 bits, not mirrored, projector always on.
extern const CameraStream depth_camera;

/// The picture in which the Kinect finds its depths: 640 x 488, 30 Hz, 10 bits, not mirrored,
/// projector always on.
extern const CameraStream infrared_camera;

/// A frame of raw readings, `lost_reading` where its packet was lost, and the arrival of its first
/// packet. The exposure ended before that.
struct RawFrame {
  std::span<const std::uint16_t> readings = {};
  std::chrono::steady_clock::time_point time = {};
};

/// A Kinect v1 on USB, by libusb: libfreenect 0.5.3, which Debian has, waits for control transfers
/// without an end, sends commands too fast for a Raspberry Pi 3, resets the audio part at each
/// opening, and drops the rest of a frame after 5 lost packets.
///
/// Its colour camera is never started: a Raspberry Pi has no bandwidth for it and depth. Its audio
/// part is left alone: a reset, which models 1473 and for Windows need before their accelerometer
/// answers, makes some of them vanish.
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

  /// @return false if a stream runs, which does not allow a change, or the device refuses
  bool set_near_mode(bool on);

  struct Release {
    void operator()(std::atomic<bool>* is_used) const { *is_used = false; }
  };
  /// The use of the camera, until this is destroyed.
  using Use = std::unique_ptr<std::atomic<bool>, Release>;

  /// @return null if somebody else uses the camera: it has one stream at a time
  Use use() { return is_used_.exchange(true) ? nullptr : Use(&is_used_); }

  /// Runs one of the streams until a stop is requested or the device is gone; then returns within
  /// 2 s.
  /// @param use       of this camera
  /// @param on_frame  receives each frame of which at least 80 % of the packets arrived
  void stream(Use use, const CameraStream& stream, const std::stop_token& stop,
              const std::function<void(const RawFrame&)>& on_frame);

  PacketCounts packet_counts() const;

  /// Logs the stream's next packets, at most `count`, and forgets an earlier log.
  void log_packets(std::size_t count);

  /// Takes packets from the log, the oldest first, as many as fit. @return their number
  std::size_t take_logged(std::span<UsbPacket> packets);

  /// Whether it was unplugged, or hangs.
  bool is_lost() const { return is_lost_; }

 private:
  bool count_packets(const ReceivedFrame& frame, const PacketFormat& format);
  void log(const IsoPacket& packet);

  std::atomic<bool> is_used_ = false;  // camera_ and commands_ are, by whoever has its `use`
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
