#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <functional>
#include <span>
#include <vector>

#include "kinect/packet_frames.hpp"

// The input is a list of packets: two bytes for its length, little-endian, then the packet.
// Whatever they are, a frame lacks packets in rising order, and never all of them; and every
// reading that a lost packet had a bit of is lost. The first byte chooses among depth, infrared
// pictures and a stream of few, short packets, which an input can fill.

namespace {

octurn::PacketFormat chosen_by(std::uint8_t byte) {
  if ((byte & 1U) != 0) {
    return octurn::depth_packets;
  }
  return (byte & 2U) != 0
             ? octurn::infrared_packets
             : octurn::PacketFormat{
                   .stream = 0x70, .reading_bits = 11, .frame_bytes = 22, .payload_bytes = 4};
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace octurn;
  std::span<const std::uint8_t> input(data, size);
  if (input.empty()) {
    return 0;
  }
  const PacketFormat format = chosen_by(input[0]);
  const std::size_t of_packet = 8 * format.payload_bytes / format.reading_bits;
  input = input.subspan(1);
  PacketFrames frames(format, [&](const ReceivedFrame& frame) {
    const auto packets = static_cast<std::size_t>(format.packets());
    const bool rising =
        std::ranges::adjacent_find(frame.lost, std::greater_equal()) == frame.lost.end();
    if (frame.bytes.size() != format.frame_bytes || frame.lost.size() >= packets || !rising) {
      std::abort();
    }
    std::vector<std::uint16_t> readings(8 * format.frame_bytes / format.reading_bits);
    unpack_readings(frame, format, readings);
    const auto lost = static_cast<std::size_t>(std::ranges::count(readings, lost_reading));
    if (lost + 600 < frame.lost.size() * of_packet || lost > frame.lost.size() * (of_packet + 2)) {
      std::abort();
    }
  });
  while (input.size() >= 2) {
    const std::size_t told = input[0] | std::size_t{input[1]} << 8U;
    const std::size_t bytes = std::min(told, input.size() - 2);
    frames.take(input.subspan(2, bytes), {});
    input = input.subspan(2 + bytes);
  }
  return 0;
}
