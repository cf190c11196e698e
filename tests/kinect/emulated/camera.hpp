#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <span>
#include <utility>
#include <vector>

#include "kinect/emulated/emulated_kinect.hpp"

namespace octurn {

/// The camera of a Kinect v1 as it speaks over USB: commands and their replies by control
/// transfers, and depth in isochronous packets, one for each microframe of 125 us.
class Camera {
 public:
  using Reading = std::uint16_t;
  static constexpr std::size_t pixels = std::size_t{640} * 480;
  /// What is seen in each frame since the stream began: a view that lives until the next call.
  using Frames = std::function<std::span<const Reading>(int frame)>;
  static constexpr int packets_in_frame = 242;  // of 1748 bytes, the last of 1132
  static constexpr int microframes_in_frame = 267;

  Camera(EmulatedKinect& kinect, Frames frames) : kinect_(kinect), frames_(std::move(frames)) {}

  /// Takes a command. @return whether it is one
  bool command(std::span<const std::uint8_t> message);

  /// Hands over the reply to the last command.
  std::vector<std::uint8_t> take_reply() { return std::exchange(reply_, {}); }

  /// What comes on the depth endpoint in the next microframe.
  /// @return bytes written to `packet`, 0 if none comes
  int next_packet(std::span<std::uint8_t> packet);

 private:
  std::vector<std::uint8_t> answer(std::uint16_t command, std::span<const std::uint8_t> body);
  void write_register(std::uint16_t address, std::uint16_t value);
  void begin_frame();
  bool is_lost(int packet) const;

  EmulatedKinect& kinect_;
  Frames frames_;
  std::map<std::uint16_t, std::uint16_t> registers_ = {};
  std::vector<std::uint8_t> reply_ = {};
  std::vector<std::uint8_t> packed_ = {};  // the frame that is being sent, 11 bits a reading
  int frame_ = -1;                         // since the stream began
  int microframe_ = 0;                     // of the frame
  bool frame_is_damaged_ = false;
  std::uint8_t sequence_ = 0;
};

/// The same frames again and again. @param frames  a whole number of them, at least one
Camera::Frames over_and_over(std::span<const Camera::Reading> frames);

}  // namespace octurn
