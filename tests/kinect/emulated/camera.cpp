#include "kinect/emulated/camera.hpp"

#include <algorithm>
#include <cstring>

namespace octurn {
namespace {

constexpr std::size_t header_bytes = 12;

void put16(std::span<std::uint8_t> to, std::size_t at, std::uint16_t value) {
  to[at] = static_cast<std::uint8_t>(value & 0xFFU);
  to[at + 1] = static_cast<std::uint8_t>(value >> 8U);
}

std::uint16_t get16(std::span<const std::uint8_t> from, std::size_t at) {
  return at + 2 <= from.size() ? static_cast<std::uint16_t>(from[at] | from[at + 1] << 8U)
                               : std::uint16_t{0};
}

/// Packs readings, the first in the most significant bits.
std::vector<std::uint8_t> packed(std::span<const EmulatedCamera::Reading> readings,
                                 unsigned reading_bits) {
  std::vector<std::uint8_t> bytes;
  bytes.reserve(readings.size() * reading_bits / 8);
  std::uint32_t bits = 0;
  unsigned held = 0;
  for (const EmulatedCamera::Reading reading : readings) {
    bits = bits << reading_bits | (reading & ((1U << reading_bits) - 1));
    for (held += reading_bits; held >= 8;) {
      held -= 8;
      bytes.push_back(static_cast<std::uint8_t>(bits >> held & 0xFFU));
    }
  }
  return bytes;
}

}  // namespace

bool EmulatedCamera::command(std::span<const std::uint8_t> message) {
  if (message.size() < 8 || message[0] != 'G' || message[1] != 'M' ||
      message.size() != 8 + std::size_t{2} * get16(message, 2)) {
    return false;
  }
  const std::vector<std::uint8_t> body = answer(get16(message, 4), message.subspan(8));
  reply_.assign(message.begin(), message.begin() + 8);  // the reply echoes command and tag
  reply_[0] = 'R';
  reply_[1] = 'B';
  put16(reply_, 2, static_cast<std::uint16_t>(body.size() / 2));
  reply_.insert(reply_.end(), body.begin(), body.end());
  not_ready_ = kinect_.not_ready;
  return true;
}

std::vector<std::uint8_t> EmulatedCamera::take_reply() {
  if (not_ready_ > 0) {
    --not_ready_;
    return {};
  }
  if (kinect_.stale_replies > 0) {
    --kinect_.stale_replies;
    return reply_before_;
  }
  reply_before_ = reply_;
  if (kinect_.short_replies > 0) {
    --kinect_.short_replies;
    reply_.resize(reply_.size() / 2);
  }
  return std::exchange(reply_, {});
}

std::vector<std::uint8_t> EmulatedCamera::answer(std::uint16_t command,
                                                 std::span<const std::uint8_t> body) {
  const bool is_1414 = kinect_.model == KinectModel::k1414;
  std::vector<std::uint8_t> reply(2);
  switch (command) {
    case 0x02:  // read a register
      reply.resize(4);
      put16(reply, 2, registers_[get16(body, 0)]);
      break;
    case 0x03:
      write_register(get16(body, 0), get16(body, 2));
      break;
    case 0x04: {  // factory calibration
      reply.resize(is_1414 ? 322 : 334);
      const std::array<float, 4> plane = {kinect_.baseline_cm, 2.3F, kinect_.reference_distance_cm,
                                          kinect_.reference_pixel_cm};
      std::memcpy(&reply[94], plane.data(), sizeof plane);
      break;
    }
    case 0x16:  // algorithm parameters
      reply.resize(get16(body, 0) == 0x40 ? 118 : get16(body, 0) == 0x41 ? 8 : 4);
      if (get16(body, 0) == 0) {
        put16(reply, 2, kinect_.shift);
      }
      break;
    case 0x95:  // a register of the colour sensor
      reply.resize(6);
      break;
    default:
      break;
  }
  return reply;
}

void EmulatedCamera::write_register(std::uint16_t address, std::uint16_t value) {
  registers_[address] = value;
  if (address == 0x05) {
    kinect_.video_starts += value != 0 ? 1 : 0;
    // Infrared, 10 bits, 640 x 488, 30 Hz.
    kinect_.infrared_on = value == 3 && registers_[0x19] == 0 && registers_[0x1A] == 1 &&
                          registers_[0x1B] == 30 && infrared_.frames;
    infrared_.start();
  }
  if (address == 0x06) {
    kinect_.depth_on = value == 2;
    depth_.start();
  }
  if (address == 0x105) {
    kinect_.projector_cycles = value != 0;
  }
  kinect_.near_mode =
      registers_.contains(0x02EF) && registers_[0x02EF] == 0 && registers_[0x15] == 7;
}

void EmulatedCamera::Stream::start() {
  frame = -1;
  microframe = 0;
}

void EmulatedCamera::Stream::begin_frame(bool is_mirrored) {
  ++frame;
  frame_is_damaged = false;
  const std::span<const Reading> seen = frames(frame);
  std::vector<Reading> sent(seen.begin(), seen.end());
  for (auto row = sent.begin(); is_mirrored && row != sent.end(); row += 640) {
    std::reverse(row, row + 640);
  }
  packed = octurn::packed(sent, reading_bits);
}

/// Whether nobody has asked for infrared pictures that are not mirrored.
bool EmulatedCamera::is_mirrored(const Stream& stream) const {
  const auto mirrors = registers_.find(0x48);
  return &stream == &infrared_ && (mirrors == registers_.end() || mirrors->second != 0);
}

int EmulatedCamera::next_packet(std::span<std::uint8_t> packet, int endpoint) {
  const bool is_depth = endpoint == depth_endpoint;
  Stream& stream = is_depth ? depth_ : infrared_;
  if (!(is_depth ? kinect_.depth_on : kinect_.infrared_on) || kinect_.silent) {
    return 0;
  }
  if (stream.microframe == 0) {
    stream.begin_frame(is_mirrored(stream));
  }
  const int number = stream.microframe;
  const int packets = stream.packets_in_frame();
  stream.microframe = (stream.microframe + 1) % microframes_in_frame;
  if (number >= packets) {
    return 0;
  }
  const bool is_last = number + 1 == packets;
  const auto flag = static_cast<std::uint8_t>(stream.flags | (number == 0 ? 1U
                                                              : is_last   ? 5U
                                                                          : 2U));
  const std::array<std::uint8_t, header_bytes> header = {'R', 'B', 0, flag, 0, stream.sequence++};
  const std::size_t begin = static_cast<std::size_t>(number) * stream.payload_bytes;
  std::size_t bytes = std::min(stream.payload_bytes, stream.frame_bytes - begin);
  if (stream.frame % kinect_.loss_period == 0 && number == kinect_.cut_packet) {
    bytes /= 2;
    stream.frame_is_damaged = true;
  }
  if (is_lost(stream, number)) {
    stream.frame_is_damaged = true;
    bytes = 0;
  }
  if (is_last) {
    ++kinect_.frames_sent;
    kinect_.frames_damaged += stream.frame_is_damaged ? 1 : 0;
  }
  if (bytes == 0 || packet.size() < header_bytes + bytes) {
    return 0;
  }
  std::ranges::copy(header, packet.begin());
  std::memcpy(&packet[header_bytes], &stream.packed[begin], bytes);
  return static_cast<int>(header_bytes + bytes);
}

/// Whether a packet of this frame is among those that this frame or the previous one loses, or is
/// lost by chance, in a burst or in a recording.
bool EmulatedCamera::is_lost(Stream& stream, int packet) {
  constexpr int burst_period = 7283;  // a second has 7260 of depth: bursts hit frames elsewhere
  const bool in_burst = ++stream.packets % burst_period < kinect_.burst;
  if (in_burst || std::uniform_real_distribution()(random_) < kinect_.random_loss) {
    return true;
  }
  const auto sent = static_cast<std::size_t>(stream.frame * stream.packets_in_frame() + packet);
  if (!losses_.empty() && losses_[sent % losses_.size()]) {
    return true;
  }
  const auto loses = [this](int frame, int number) {
    return frame >= 0 && frame % kinect_.loss_period == 0 && number >= kinect_.first_lost &&
           number < kinect_.first_lost + kinect_.lost_packets;
  };
  return loses(stream.frame, packet) || loses(stream.frame - 1, packet + stream.packets_in_frame());
}

EmulatedCamera::Frames over_and_over(std::span<const EmulatedCamera::Reading> frames,
                                     std::size_t pixels) {
  return [frames, pixels](int frame) {
    return frames.subspan(static_cast<std::size_t>(frame) * pixels % frames.size(), pixels);
  };
}

}  // namespace octurn
