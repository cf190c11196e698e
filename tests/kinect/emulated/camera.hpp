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

/// The USB side of a Kinect v1's camera: commands and replies by control transfers, and depth in
/// isochronous packets, one for each microframe of 125 us.
class EmulatedCamera {
 public:
  using Reading = std::uint16_t;
  static constexpr std::size_t pixels = std::size_t{640} * 480;
  /// Returns the readings of a frame, counted since the stream began; valid until the next call.
  using Frames = std::function<std::span<const Reading>(int frame)>;
  static constexpr int packets_in_frame = 242;  // of 1748 bytes, the last of 1132
  static constexpr int microframes_in_frame = 267;

  /// @param losses  whether each packet since the stream began is lost, over and over
  EmulatedCamera(EmulatedKinect& kinect, Frames frames, std::vector<bool> losses = {})
      : kinect_(kinect), frames_(std::move(frames)), losses_(std::move(losses)) {}

  /// Accepts a command. @return false if the message is no command
  bool command(std::span<const std::uint8_t> message);

  /// Moves out the reply to the last command, or what the faulty firmware sends in its place.
  std::vector<std::uint8_t> take_reply();

  /// Writes the depth endpoint's packet of the next microframe.
  /// @return bytes written to `packet`, 0 if that microframe has no packet
  int next_packet(std::span<std::uint8_t> packet);

 private:
  std::vector<std::uint8_t> answer(std::uint16_t command, std::span<const std::uint8_t> body);
  void write_register(std::uint16_t address, std::uint16_t value);
  void begin_frame();
  bool is_lost(int packet);

  EmulatedKinect& kinect_;
  Frames frames_;
  std::vector<bool> losses_;
  std::map<std::uint16_t, std::uint16_t> registers_ = {};
  std::vector<std::uint8_t> reply_ = {};
  std::vector<std::uint8_t> reply_before_ = {};
  int not_ready_ = 0;                      // times that the reply is still asked for in vain
  std::vector<std::uint8_t> packed_ = {};  // the frame that is being sent, 11 bits a reading
  int frame_ = -1;                         // counted since the stream began
  int microframe_ = 0;                     // counted within the frame
  bool frame_is_damaged_ = false;
  std::uint8_t sequence_ = 0;
  int packets_ = 0;  // sent or lost
  std::minstd_rand random_ = {};
};

/// Repeats a sequence of frames. @param frames  readings of one or more whole frames
EmulatedCamera::Frames over_and_over(std::span<const EmulatedCamera::Reading> frames);

}  // namespace octurn
