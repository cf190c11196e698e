#pragma once

#include <libfreenect.h>

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

#include "kinect/depth_table.hpp"
#include "rig/tilt.hpp"

namespace octurn {

/// A frame of 640 x 480 raw readings, and the arrival of its first packet. The exposure ended
/// before that.
struct RawFrame {
  std::span<const std::uint16_t> readings = {};
  std::chrono::steady_clock::time_point time = {};
};

/// A Kinect v1 on USB, by libfreenect. Its colour camera is never started: a Raspberry Pi has no
/// bandwidth for both.
class Kinect {
 public:
  /// @param index  among the Kinects that are plugged in
  /// @throws Error "sensor-missing"
  explicit Kinect(int index);
  ~Kinect();
  Kinect(const Kinect&) = delete;
  Kinect& operator=(const Kinect&) = delete;

  /// The number of Kinects that are plugged in.
  static int count();

  const KinectParameters& parameters() const { return parameters_; }

  /// The tilt by its accelerometer, which is read once a second while the stream runs. Nothing if
  /// the model has no accelerometer that can be read.
  std::optional<Tilt> tilt() const;

  bool has_near_mode() const { return has_near_mode_; }

  /// @return false if the depth stream runs, which does not allow a change, or the device refuses
  bool set_near_mode(bool on);

  /// Runs the depth stream until a stop is requested or the device is gone.
  /// @param on_frame  receives each complete frame; a frame with a lost packet is dropped
  void stream(const std::stop_token& stop, const std::function<void(const RawFrame&)>& on_frame);

  /// The number of frames that were dropped because they had lost packets.
  int damaged_frames() const { return damaged_frames_; }

  /// Whether it was unplugged.
  bool is_lost() const { return is_lost_; }

 private:
  struct End {
    void operator()(freenect_context* context) const { freenect_shutdown(context); }
  };
  using Context = std::unique_ptr<freenect_context, End>;

  /// The frame that is being received, packet by packet.
  struct Incoming {
    int packets_in_order = 0;  // -1 once one was missing
    std::chrono::steady_clock::time_point begin = {};
  };

  static Context make_context(int subdevices);
  bool open(int index, int subdevices);
  void read_parameters();
  void read_tilt();
  void take_packet(std::byte* frame, const void* data, int number, int bytes);
  void take_frame(const std::uint16_t* readings);

  std::mutex usb_;   // guards libfreenect's device; held while a stream runs
  Context context_;  // closes the device when it ends
  freenect_device* device_ = nullptr;
  KinectParameters parameters_ = {};
  bool has_near_mode_ = false;
  bool has_accelerometer_ = false;
  mutable std::mutex tilt_mutex_;  // guards tilt_
  std::optional<Tilt> tilt_ = {};
  std::atomic<bool> is_lost_ = false;
  std::atomic<int> damaged_frames_ = 0;
  const std::function<void(const RawFrame&)>* on_frame_ = nullptr;  // while a stream runs
  Incoming incoming_ = {};
};

}  // namespace octurn
