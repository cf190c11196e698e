#include "kinect/emulated/usbip_device.hpp"

#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <cerrno>

namespace octurn {
namespace {

// A message is a header of 48 bytes, big-endian 32-bit words, followed by data and packets.
constexpr std::size_t header_bytes = 48;
constexpr std::size_t setup_at = 40;
constexpr std::size_t packet_bytes = 16;
enum Word : std::size_t {
  command = 0,
  sequence = 1,
  direction = 3,
  endpoint = 4,
  status = 5,        // of a reply; in CMD_UNLINK the transfer to unlink
  buffer_bytes = 6,  // in a reply, the bytes transferred
  packets = 8,
};
constexpr std::uint32_t submit = 1;
constexpr std::uint32_t unlink_command = 2;
constexpr std::uint32_t submitted = 3;
constexpr std::uint32_t unlinked = 4;
constexpr std::uint32_t not_isochronous = 0xFFFFFFFF;

// Negative errno values of the kernel, as the device's side sends them.
constexpr std::uint32_t stalled = 0U - EPIPE;
constexpr std::uint32_t was_unlinked = 0U - ECONNRESET;

// Far above what the driver asks for: 16 packets of 1920 bytes.
constexpr std::uint32_t max_buffer_bytes = 1U << 20U;
constexpr std::uint32_t max_packets = 1024;

std::uint32_t word(std::span<const std::uint8_t> bytes, std::size_t number) {
  const auto four = bytes.subspan(4 * number, 4);
  return std::uint32_t{four[0]} << 24U | std::uint32_t{four[1]} << 16U |
         std::uint32_t{four[2]} << 8U | four[3];
}

void put_word(std::span<std::uint8_t> bytes, std::size_t number, std::uint32_t value) {
  for (std::size_t i = 0; i < 4; ++i) {
    bytes[4 * number + i] = static_cast<std::uint8_t>(value >> (24 - 8 * i) & 0xFFU);
  }
}

UsbSetup setup_of(std::span<const std::uint8_t> header) {
  const auto at = header.subspan(setup_at);  // little-endian 16-bit words
  const auto two = [&](std::size_t i) {
    return static_cast<std::uint16_t>(at[i] | at[i + 1] << 8);
  };
  return {.type = at[0], .request = at[1], .value = two(2), .index = two(4), .length = two(6)};
}

std::vector<std::uint8_t> reply_to(std::uint32_t reply, std::uint32_t of, std::uint32_t state) {
  std::vector<std::uint8_t> message(header_bytes);
  put_word(message, command, reply);
  put_word(message, sequence, of);
  put_word(message, status, state);
  return message;
}

/// Reads exactly `bytes.size()` bytes. @return false if the peer closed before that
bool receive(int socket, std::span<std::uint8_t> bytes) {
  while (!bytes.empty()) {
    const ssize_t count = ::recv(socket, bytes.data(), bytes.size(), 0);
    if (count <= 0) {
      if (count < 0 && errno == EINTR) {
        continue;
      }
      return false;
    }
    bytes = bytes.subspan(static_cast<std::size_t>(count));
  }
  return true;
}

}  // namespace

bool UsbipDevice::take_message() {
  std::array<std::uint8_t, header_bytes> header = {};
  if (!receive(socket_.number(), header)) {
    return false;
  }
  switch (word(header, command)) {
    case submit:
      return take_transfer(header);
    case unlink_command:
      return unlink(word(header, sequence), word(header, status));
    default:
      return false;
  }
}

bool UsbipDevice::take_transfer(std::span<const std::uint8_t> header) {
  const bool is_in = word(header, direction) != 0;
  const std::uint32_t bytes = word(header, buffer_bytes);
  const std::uint32_t count = word(header, packets);
  if (bytes > max_buffer_bytes || (count != not_isochronous && count > max_packets)) {
    return false;
  }
  std::vector<std::uint8_t> data(bytes);
  if (!is_in && !receive(socket_.number(), data)) {
    return false;
  }
  if (count == 0 || count == not_isochronous) {
    return answer_control(word(header, sequence), setup_of(header), std::move(data));
  }
  std::vector<std::uint8_t> descriptors(count * packet_bytes);
  if (!receive(socket_.number(), descriptors)) {
    return false;
  }
  count_delay();
  Transfer transfer = {.sequence = word(header, sequence), .endpoint = word(header, endpoint)};
  for (std::uint32_t i = 0; i < count; ++i) {
    transfer.packet_bytes.push_back(
        std::min(word(std::span(descriptors).subspan(i * packet_bytes), 1), bytes));
  }
  using namespace std::chrono_literals;
  const auto begin = waiting_.empty() ? std::max(over_, Clock::now()) : waiting_.back().due;
  transfer.due =
      begin + std::chrono::duration_cast<Clock::duration>(count * 125us / kinect_.speed.load());
  waiting_.push_back(std::move(transfer));
  return true;
}

void UsbipDevice::count_delay() {
  if (!completed_.empty()) {
    if (const auto since = completed_.front()) {
      delays_.push_back(Clock::now() - *since);
    }
    completed_.pop_front();
  }
}

bool UsbipDevice::unlink(std::uint32_t sequence, std::uint32_t of) {
  const auto found = std::ranges::find(waiting_, of, &Transfer::sequence);
  const bool waits = found != waiting_.end();
  completed_.clear();  // the stream ends
  if (waits) {
    waiting_.erase(found);
  }
  return send(reply_to(unlinked, sequence, waits ? was_unlinked : 0));
}

bool UsbipDevice::answer_control(std::uint32_t sequence, const UsbSetup& setup,
                                 std::vector<std::uint8_t> data) {
  const bool is_vendors = (setup.type & 0x60U) == 0x40U;
  std::optional<std::size_t> transferred;
  if (is_vendors) {
    transferred = vendor_request(part_, setup, kinect_, camera_, data);
  } else if (const auto reply = standard_request(part_, setup, kinect_.model)) {
    transferred = std::min(reply->size(), data.size());
    std::copy_n(reply->begin(), *transferred, data.begin());
  }
  std::vector<std::uint8_t> message = reply_to(submitted, sequence, transferred ? 0 : stalled);
  put_word(message, buffer_bytes, static_cast<std::uint32_t>(transferred.value_or(0)));
  put_word(message, packets, not_isochronous);
  if (setup.is_in()) {
    message.insert(message.end(), data.begin(),
                   data.begin() + static_cast<std::ptrdiff_t>(transferred.value_or(0)));
  }
  return send(message);
}

std::optional<UsbipDevice::Clock::time_point> UsbipDevice::due() const {
  return waiting_.empty() ? std::nullopt : std::optional(waiting_.front().due);
}

bool UsbipDevice::complete(Clock::time_point now) {
  const auto begin = Clock::now();
  const Transfer transfer = std::move(waiting_.front());
  waiting_.pop_front();
  over_ = std::max(transfer.due, now);
  const auto count = static_cast<std::uint32_t>(transfer.packet_bytes.size());
  std::vector<std::uint8_t> message = reply_to(submitted, transfer.sequence, 0);
  put_word(message, packets, count);
  std::vector<std::uint8_t> descriptors(count * packet_bytes);
  std::uint32_t offset = 0;
  for (std::size_t i = 0; i < count; ++i) {
    // Packets' data are contiguous in the message, without the gaps of the transfer's buffer.
    const std::size_t end = message.size();
    message.resize(end + transfer.packet_bytes[i]);
    const auto bytes = static_cast<std::size_t>(
        camera_.next_packet(std::span(message).subspan(end), static_cast<int>(transfer.endpoint)));
    message.resize(end + bytes);
    const auto descriptor = std::span(descriptors).subspan(i * packet_bytes, packet_bytes);
    put_word(descriptor, 0, offset);
    put_word(descriptor, 1, transfer.packet_bytes[i]);
    put_word(descriptor, 2, static_cast<std::uint32_t>(bytes));
    offset += transfer.packet_bytes[i];
  }
  put_word(message, buffer_bytes, static_cast<std::uint32_t>(message.size() - header_bytes));
  message.insert(message.end(), descriptors.begin(), descriptors.end());
  if (!send(message)) {
    return false;
  }
  constexpr auto copying = std::chrono::milliseconds(1);
  const auto end = Clock::now();
  if (end - begin > copying) {  // a frame was made
    std::ranges::fill(completed_, std::nullopt);
  }
  completed_.push_back(end);
  return true;
}

bool UsbipDevice::send(std::span<const std::uint8_t> bytes) {
  while (!bytes.empty()) {
    const ssize_t count = ::send(socket_.number(), bytes.data(), bytes.size(), MSG_NOSIGNAL);
    if (count < 0 && errno != EINTR) {
      return false;
    }
    bytes = bytes.subspan(static_cast<std::size_t>(std::max(count, ssize_t{0})));
  }
  return true;
}

}  // namespace octurn
