#include "kinect/emulated/camera.hpp"

#include <algorithm>
#include <cstring>

namespace octurn {
namespace {

constexpr std::size_t header_bytes = 12;
constexpr std::size_t packet_bytes = 1748;
constexpr std::size_t frame_bytes = EmulatedCamera::pixels * 11 / 8;

void put16(std::span<std::uint8_t> to, std::size_t at, std::uint16_t value) {
  to[at] = static_cast<std::uint8_t>(value & 0xFFU);
  to[at + 1] = static_cast<std::uint8_t>(value >> 8U);
}

std::uint16_t get16(std::span<const std::uint8_t> from, std::size_t at) {
  return at + 2 <= from.size() ? static_cast<std::uint16_t>(from[at] | from[at + 1] << 8U)
                               : std::uint16_t{0};
}

/// Packs readings into 11 bits each, the first in the most significant bits.
std::vector<std::uint8_t> packed(std::span<const EmulatedCamera::Reading> readings) {
  std::vector<std::uint8_t> bytes;
  bytes.reserve(frame_bytes);
  std::uint32_t bits = 0;
  unsigned held = 0;
  for (const EmulatedCamera::Reading reading : readings) {
    bits = bits << 11U | (reading & 0x7FFU);
    for (held += 11; held >= 8;) {
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
  if (address == 0x05 && value != 0) {
    ++kinect_.video_starts;
  }
  if (address == 0x06) {
    kinect_.depth_on = value == 2;
    frame_ = -1;
    microframe_ = 0;
  }
  kinect_.near_mode =
      registers_.contains(0x02EF) && registers_[0x02EF] == 0 && registers_[0x15] == 7;
}

int EmulatedCamera::next_packet(std::span<std::uint8_t> packet) {
  if (!kinect_.depth_on || kinect_.silent) {
    return 0;
  }
  if (microframe_ == 0) {
    begin_frame();
  }
  const int number = microframe_;
  microframe_ = (microframe_ + 1) % microframes_in_frame;
  if (number >= packets_in_frame) {
    return 0;
  }
  const bool is_last = number + 1 == packets_in_frame;
  const auto flag = static_cast<std::uint8_t>(number == 0 ? 0x71 : is_last ? 0x75 : 0x72);
  const std::array<std::uint8_t, header_bytes> header = {'R', 'B', 0, flag, 0, sequence_++};
  std::size_t bytes = is_last ? frame_bytes % packet_bytes : packet_bytes;
  if (frame_ % kinect_.loss_period == 0 && number == kinect_.cut_packet) {
    bytes /= 2;
    frame_is_damaged_ = true;
  }
  if (is_lost(number)) {
    frame_is_damaged_ = true;
    bytes = 0;
  }
  if (is_last) {
    ++kinect_.frames_sent;
    kinect_.frames_damaged += frame_is_damaged_ ? 1 : 0;
  }
  if (bytes == 0 || packet.size() < header_bytes + bytes) {
    return 0;
  }
  std::ranges::copy(header, packet.begin());
  std::memcpy(&packet[header_bytes], &packed_[static_cast<std::size_t>(number) * packet_bytes],
              bytes);
  return static_cast<int>(header_bytes + bytes);
}

void EmulatedCamera::begin_frame() {
  ++frame_;
  frame_is_damaged_ = false;
  packed_ = packed(frames_(frame_));
}

/// Whether a packet of this frame is among those that this frame or the previous one loses, or is
/// lost by chance, in a burst or in a recording.
bool EmulatedCamera::is_lost(int packet) {
  constexpr int burst_period = 7283;  // a second has 7260: each burst hits frames elsewhere
  const bool in_burst = ++packets_ % burst_period < kinect_.burst;
  if (in_burst || std::uniform_real_distribution()(random_) < kinect_.random_loss) {
    return true;
  }
  const auto sent = static_cast<std::size_t>(frame_) * packets_in_frame;
  if (!losses_.empty() && losses_[(sent + static_cast<std::size_t>(packet)) % losses_.size()]) {
    return true;
  }
  const auto loses = [this](int frame, int number) {
    return frame >= 0 && frame % kinect_.loss_period == 0 && number >= kinect_.first_lost &&
           number < kinect_.first_lost + kinect_.lost_packets;
  };
  return loses(frame_, packet) || loses(frame_ - 1, packet + packets_in_frame);
}

EmulatedCamera::Frames over_and_over(std::span<const EmulatedCamera::Reading> frames) {
  return [frames](int frame) {
    return frames.subspan(static_cast<std::size_t>(frame) * EmulatedCamera::pixels % frames.size(),
                          EmulatedCamera::pixels);
  };
}

}  // namespace octurn
