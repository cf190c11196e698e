#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <random>
#include <span>
#include <utility>
#include <vector>

#include "kinect/emulated/emulated_kinect.hpp"

namespace octurn {

/// The USB side of a Kinect v1's camera: commands and replies by control transfers, and depth and
/// infrared pictures in isochronous packets, one for each microframe of 125 us.
class EmulatedCamera {
 public:
  using Reading = std::uint16_t;
  static constexpr std::size_t pixels = std::size_t{640} * 480;
  static constexpr std::size_t infrared_pixels = std::size_t{640} * 488;
  /// Returns the readings of a frame, counted since the stream began; valid until the next call.
  using Frames = std::function<std::span<const Reading>(int frame)>;
  static constexpr int packets_in_frame = 242;  // of depth: of 1748 bytes, the last of 1132
  static constexpr int microframes_in_frame = 267;
  static constexpr int video_endpoint = 1;
  static constexpr int depth_endpoint = 2;

  /// @param losses    whether each packet since the stream began is lost, over and over
  /// @param infrared  pictures of 640 x 488 readings; without it, no infrared packets are sent
  EmulatedCamera(EmulatedKinect& kinect, Frames frames, std::vector<bool> losses = {},
                 Frames infrared = {})
      : kinect_(kinect), losses_(std::move(losses)) {
    depth_.frames = std::move(frames);
    infrared_.frames = std::move(infrared);
  }

  /// Accepts a command. @return false if the message is no command
  bool command(std::span<const std::uint8_t> message);

  /// Moves out the reply to the last command, or what the faulty firmware sends in its place.
  std::vector<std::uint8_t> take_reply();

  /// Writes an endpoint's packet of the next microframe.
  /// @return bytes written to `packet`, 0 if that microframe has no packet
  int next_packet(std::span<std::uint8_t> packet, int endpoint = depth_endpoint);

 private:
  /// One of the camera's streams.
  struct Stream {
    std::uint8_t flags = 0;
    unsigned reading_bits = 0;
    std::size_t payload_bytes = 0;
    std::size_t frame_bytes = 0;
    Frames frames = {};
    std::vector<std::uint8_t> packed = {};  // the frame that is being sent
    int frame = -1;                         // counted since the stream began
    int microframe = 0;                     // counted within the frame
    bool frame_is_damaged = false;
    std::uint8_t sequence = 0;
    int packets = 0;  // sent or lost

    int packets_in_frame() const {
      return static_cast<int>((frame_bytes + payload_bytes - 1) / payload_bytes);
    }
    void start();
    void begin_frame(bool is_mirrored);
  };

  std::vector<std::uint8_t> answer(std::uint16_t command, std::span<const std::uint8_t> body);
  void write_register(std::uint16_t address, std::uint16_t value);
  bool is_mirrored(const Stream& stream) const;
  bool is_lost(Stream& stream, int packet);

  EmulatedKinect& kinect_;
  std::vector<bool> losses_;
  Stream depth_ = {
      .flags = 0x70, .reading_bits = 11, .payload_bytes = 1748, .frame_bytes = pixels * 11 / 8};
  Stream infrared_ = {.flags = 0x80,
                      .reading_bits = 10,
                      .payload_bytes = 1908,
                      .frame_bytes = infrared_pixels * 10 / 8};
  std::map<std::uint16_t, std::uint16_t> registers_ = {};
  std::vector<std::uint8_t> reply_ = {};
  std::vector<std::uint8_t> reply_before_ = {};
  int not_ready_ = 0;  // times that the reply is still asked for in vain
  std::minstd_rand random_ = {};
};

/// Repeats a sequence of frames. @param frames  readings of one or more whole frames
EmulatedCamera::Frames over_and_over(std::span<const EmulatedCamera::Reading> frames,
                                     std::size_t pixels = EmulatedCamera::pixels);

}  // namespace octurn
