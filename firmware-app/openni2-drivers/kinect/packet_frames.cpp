#include "kinect/packet_frames.hpp"

#include <algorithm>
#include <cassert>
#include <utility>

namespace octurn {
namespace {

constexpr std::size_t header_bytes = 12;

/// A packet takes at least one microframe of USB.
constexpr auto microframe = std::chrono::microseconds(125);

// The lower four bits of a header's flags.
constexpr unsigned first_packet = 1;
constexpr unsigned middle_packet = 2;
constexpr unsigned last_packet = 5;

/// @tparam reading_bits  known to the compiler, which halves the time
template <unsigned reading_bits>
void unpack(std::span<const std::uint8_t> bytes, std::span<std::uint16_t> readings) {
  constexpr std::uint32_t mask = (1U << reading_bits) - 1;
  std::uint32_t bits = 0;
  unsigned held = 0;
  auto byte = bytes.begin();
  for (std::uint16_t& reading : readings) {
    for (; held < reading_bits; held += 8) {
      bits = bits << 8U | *byte++;
    }
    held -= reading_bits;
    reading = static_cast<std::uint16_t>(bits >> held & mask);
  }
}

}  // namespace

/// The parts of a header that matter. Its other bytes are 'R', 'B', unknown ones, and a time stamp.
struct PacketFrames::Header {
  unsigned kind = 0;
  std::uint8_t sequence = 0;

  static std::optional<Header> of(std::span<const std::uint8_t> packet, std::uint8_t stream) {
    if (packet.size() < header_bytes || packet[0] != 'R' || packet[1] != 'B' ||
        (packet[3] & 0xF0U) != stream) {
      return std::nullopt;
    }
    const unsigned kind = packet[3] & 0x0FU;
    const bool known = kind == first_packet || kind == middle_packet || kind == last_packet;
    return known ? std::optional(Header{.kind = kind, .sequence = packet[5]}) : std::nullopt;
  }
};

PacketFrames::PacketFrames(const PacketFormat& format,
                           std::function<void(const ReceivedFrame&)> on_frame)
    : format_(format),
      on_frame_(std::move(on_frame)),
      bytes_(format.frame_bytes),
      arrived_(static_cast<std::size_t>(format.packets())),
      doubtful_(format.packets()) {}

void PacketFrames::take(std::span<const std::uint8_t> packet, Clock::time_point time) {
  const std::optional<Header> header = Header::of(packet, format_.stream);
  if (!header) {
    return;
  }
  const int packets = format_.packets();
  const bool is_first = header->kind == first_packet;
  const bool is_last = header->kind == last_packet;
  const int gap = static_cast<std::uint8_t>(header->sequence - sequence_);
  const int number = due_ ? (*due_ + gap) % packets : 0;
  const bool agrees = due_ && is_first == (number == 0) && is_last == (number == packets - 1);
  if (!agrees) {
    lose_place();
  }
  sequence_ = static_cast<std::uint8_t>(header->sequence + 1);
  if (!agrees && !is_first) {
    due_ = is_last ? std::optional(0) : std::nullopt;
    return;
  }
  if (agrees && gap > 0) {
    const bool ends = *due_ + gap >= packets;
    if (ends && !is_first) {
      discard_doubtful();
    }
    if (ends) {
      finish_frame();
    }
    doubtful_ = std::min(doubtful_, number);
  }
  if (is_first || is_last) {
    doubtful_ = packets;
  }
  place(number, packet.subspan(header_bytes), time);
  due_ = (number + 1) % packets;
  if (is_last) {
    finish_frame();
  }
}

/// A packet of another length than it should have counts as lost.
void PacketFrames::place(int number, std::span<const std::uint8_t> payload,
                         Clock::time_point time) {
  const auto at = static_cast<std::size_t>(number);
  const std::size_t offset = at * format_.payload_bytes;
  if (payload.size() != std::min(format_.payload_bytes, format_.frame_bytes - offset)) {
    return;
  }
  if (std::ranges::find(arrived_, true) == arrived_.end()) {
    begin_ = time - number * microframe;
  }
  std::ranges::copy(payload, bytes_.begin() + static_cast<std::ptrdiff_t>(offset));
  arrived_[at] = true;
}

/// Hands over what is certain of a frame after which a packet came that does not continue it.
void PacketFrames::lose_place() {
  discard_doubtful();
  finish_frame();
  due_ = std::nullopt;
}

void PacketFrames::discard_doubtful() {
  std::fill(arrived_.begin() + doubtful_, arrived_.end(), false);
  doubtful_ = format_.packets();
}

void PacketFrames::finish_frame() {
  std::vector<int> lost;
  for (int number = 0; number < format_.packets(); ++number) {
    if (!arrived_[static_cast<std::size_t>(number)]) {
      lost.push_back(number);
    }
  }
  if (lost.size() < arrived_.size()) {
    on_frame_({.bytes = bytes_, .lost = lost, .begin = begin_});
  }
  std::fill(arrived_.begin(), arrived_.end(), false);
  doubtful_ = format_.packets();
}

void unpack_readings(const ReceivedFrame& frame, const PacketFormat& format,
                     std::span<std::uint16_t> readings) {
  const std::size_t reading_bits = format.reading_bits;
  assert(readings.size() * reading_bits == 8 * frame.bytes.size());
  if (reading_bits == depth_packets.reading_bits) {
    unpack<depth_packets.reading_bits>(frame.bytes, readings);
  } else {
    unpack<infrared_packets.reading_bits>(frame.bytes, readings);
  }
  for (const int number : frame.lost) {
    const std::size_t first_bit = 8 * static_cast<std::size_t>(number) * format.payload_bytes;
    const std::size_t end_bit =
        std::min(first_bit + 8 * format.payload_bytes, readings.size() * reading_bits);
    const std::size_t first = first_bit / reading_bits;
    const std::size_t end = (end_bit + reading_bits - 1) / reading_bits;
    std::ranges::fill(readings.subspan(first, end - first), lost_reading);
  }
}

}  // namespace octurn
