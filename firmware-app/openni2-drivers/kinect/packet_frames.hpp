#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

namespace octurn {

/// How the Kinect's camera packs the readings of one of its streams, the first bit in front, and
/// cuts its frames into packets: each has a header of 12 bytes, then the frame's next bytes.
struct PacketFormat {
  std::uint8_t stream = 0;    ///< the upper four bits of its headers' flags
  unsigned reading_bits = 0;  ///< 10 or 11
  std::size_t frame_bytes = 0;
  std::size_t payload_bytes = 0;  ///< of each packet but the last

  int packets() const {
    return static_cast<int>((frame_bytes + payload_bytes - 1) / payload_bytes);
  }
};

/// Depth: 640 x 480 readings of 11 bits, in 242 packets.
inline constexpr PacketFormat depth_packets{.stream = 0x70,
                                            .reading_bits = 11,
                                            .frame_bytes = std::size_t{640} * 480 * 11 / 8,
                                            .payload_bytes = 1748};

/// What the infrared camera sees: 640 x 488 readings of 10 bits, in 205 packets.
inline constexpr PacketFormat infrared_packets{.stream = 0x80,
                                               .reading_bits = 10,
                                               .frame_bytes = std::size_t{640} * 488 * 10 / 8,
                                               .payload_bytes = 1908};

/// A frame as it arrived. Valid while it is handed over.
struct ReceivedFrame {
  std::span<const std::uint8_t> bytes = {};  ///< where packets were lost, those of earlier frames
  std::span<const int> lost = {};            ///< numbers of lost packets, from 0
  /// Arrival of the first packet, no earlier than the end of the exposure. If it was lost, the
  /// latest time at which it was due.
  std::chrono::steady_clock::time_point begin = {};
};

/// Puts the packets of a stream together to frames. A packet's place follows from the sequence
/// number in its header, which counts packets, lost ones as well, modulo 256. A loss of 256 or more
/// looks shorter than it was: packets after a gap therefore count as lost until the flag of a
/// frame's first or last packet arrives where it is due.
class PacketFrames {
 public:
  using Clock = std::chrono::steady_clock;

  /// @param on_frame  receives every frame of which at least one packet arrived
  PacketFrames(const PacketFormat& format, std::function<void(const ReceivedFrame&)> on_frame);

  /// Takes the next packet that arrived. Ignores what is none of the stream's.
  void take(std::span<const std::uint8_t> packet, Clock::time_point time);

 private:
  struct Header;

  void place(int number, std::span<const std::uint8_t> payload, Clock::time_point time);
  void lose_place();
  void finish_frame();
  void discard_doubtful();

  PacketFormat format_;
  std::function<void(const ReceivedFrame&)> on_frame_;
  std::vector<std::uint8_t> bytes_;
  std::vector<bool> arrived_;    // of each packet of this frame
  std::optional<int> due_ = {};  // number of the next packet; nothing until a frame begins or ends
  std::uint8_t sequence_ = 0;    // of the next packet
  int doubtful_ = 0;  // the first packet whose place is in doubt; the number of packets if none is
  Clock::time_point begin_ = {};
};

/// A reading whose packet was lost; no reading of 11 bits has this value.
inline constexpr std::uint16_t lost_reading = 0x800;

/// Unpacks the readings of a frame. Those of which a lost packet had any bit become `lost_reading`.
/// @param readings  all of a frame of that format
void unpack_readings(const ReceivedFrame& frame, const PacketFormat& format,
                     std::span<std::uint16_t> readings);

}  // namespace octurn
