#include "kinect/camera_commands.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <thread>

#include "octurn/error.hpp"

namespace octurn {
namespace {

using Bytes = std::vector<std::uint8_t>;
using Clock = CameraCommands::Clock;

// A message is the two letters, the body's length in 16-bit words, command, tag, and the body. All
// numbers are little-endian.
constexpr std::size_t header_bytes = 8;
constexpr std::size_t command_at = 4;
constexpr std::size_t max_reply_bytes = 512;

constexpr std::uint16_t write_command = 0x03;
constexpr std::uint16_t fixed_parameters_command = 0x04;
constexpr std::uint16_t algorithm_parameters_command = 0x16;

// Without a pause, Kinects do not open on a Raspberry Pi 3 (libfreenect, pull request 530).
constexpr auto poll_interval = std::chrono::milliseconds(1);
/// After it a command is sent once more.
constexpr auto reply_patience = std::chrono::milliseconds(250);
constexpr auto longest_transfer = std::chrono::milliseconds(500);

void append16(Bytes& bytes, std::uint16_t value) {
  bytes.push_back(static_cast<std::uint8_t>(value & 0xFFU));
  bytes.push_back(static_cast<std::uint8_t>(value >> 8U));
}

std::uint16_t get16(std::span<const std::uint8_t> bytes, std::size_t at) {
  return static_cast<std::uint16_t>(bytes[at] | bytes[at + 1] << 8U);
}

double get_float(std::span<const std::uint8_t> bytes, std::size_t at) {
  return static_cast<double>(
      std::bit_cast<float>(get16(bytes, at) | std::uint32_t{get16(bytes, at + 2)} << 16U));
}

/// Whether a received message is the whole reply to a sent one: with its command and tag.
bool answers(std::span<const std::uint8_t> reply, std::span<const std::uint8_t> message) {
  return reply.size() >= header_bytes && reply[0] == 'R' && reply[1] == 'B' &&
         std::ranges::equal(reply.subspan(command_at, 4), message.subspan(command_at, 4)) &&
         reply.size() == header_bytes + std::size_t{2} * get16(reply, 2);
}

ControlEndpoint::Timeout timeout_before(Clock::time_point deadline) {
  const auto left = std::chrono::ceil<std::chrono::milliseconds>(deadline - Clock::now());
  return std::clamp(left, std::chrono::milliseconds(1), longest_transfer);
}

bool is_sound(const KinectParameters& parameters) {
  const auto is_positive = [](double value) { return std::isfinite(value) && value > 0; };
  return is_positive(parameters.baseline_cm) && is_positive(parameters.reference_distance_cm) &&
         is_positive(parameters.reference_pixel_cm) && is_positive(parameters.shift);
}

}  // namespace

KinectParameters CameraCommands::parameters(Clock::time_point deadline) {
  constexpr std::array<std::uint16_t, 5> from_the_start = {};
  // The shift, at 640 x 480 and 30 Hz.
  constexpr std::array<std::uint16_t, 5> shift = {0, 0, 1, 30, 0};
  const Bytes fixed = send(fixed_parameters_command, from_the_start, 110, deadline);
  const Bytes algorithm = send(algorithm_parameters_command, shift, 4, deadline);
  const KinectParameters parameters{.baseline_cm = get_float(fixed, 94),
                                    .reference_distance_cm = get_float(fixed, 102),
                                    .reference_pixel_cm = get_float(fixed, 106),
                                    .shift = static_cast<double>(get16(algorithm, 2))};
  if (!is_sound(parameters)) {
    throw Error(ErrorCode::sensor_failed, "kinect: its factory parameters make no sense");
  }
  return parameters;
}

void CameraCommands::write_register(std::uint16_t address, std::uint16_t value,
                                    Clock::time_point deadline) {
  send(write_command, std::array{address, value}, 0, deadline);
}

/// @param reply_bytes  that the reply has at least
/// @return the reply without its header
Bytes CameraCommands::send(std::uint16_t command, std::span<const std::uint16_t> words,
                           std::size_t reply_bytes, Clock::time_point deadline) {
  do {
    Bytes message{'G', 'M'};
    append16(message, static_cast<std::uint16_t>(words.size()));
    append16(message, command);
    append16(message, ++tag_);
    for (const std::uint16_t word : words) {
      append16(message, word);
    }
    if (endpoint_.write(message, timeout_before(deadline)) == static_cast<int>(message.size())) {
      std::optional<Bytes> reply =
          reply_to(message, std::min(deadline, Clock::now() + reply_patience));
      if (reply && reply->size() >= reply_bytes) {
        return *std::move(reply);
      }
    }
    std::this_thread::sleep_for(poll_interval);
  } while (Clock::now() < deadline);
  throw Error(ErrorCode::sensor_failed,
              "kinect: its camera does not answer command " + std::to_string(command));
}

/// Asks for the reply until it is there. The first answers may be nothing, or the reply to an
/// earlier command.
std::optional<Bytes> CameraCommands::reply_to(std::span<const std::uint8_t> message,
                                              Clock::time_point deadline) {
  std::array<std::uint8_t, max_reply_bytes> buffer = {};
  do {
    const int count = endpoint_.read(buffer, timeout_before(deadline));
    if (count < 0) {
      return std::nullopt;
    }
    const std::span reply(buffer.data(), static_cast<std::size_t>(count));
    if (answers(reply, message)) {
      return Bytes(reply.begin() + header_bytes, reply.end());
    }
    std::this_thread::sleep_for(poll_interval);
  } while (Clock::now() < deadline);
  return std::nullopt;
}

}  // namespace octurn
