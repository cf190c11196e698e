#include "rig/usb_log.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>
#include <system_error>

#include "octurn/error.hpp"

namespace octurn {
namespace {

constexpr std::string_view first_line = "octurn-usb 1";
constexpr std::string_view last_line = "end";
constexpr std::string_view digits = "0123456789abcdef";
constexpr std::int64_t max_time_us = std::int64_t{600} * 1'000'000;

// Of a depth stream: 242 packets a frame, 30 frames a second. Longer losses than twice the range of
// sequence numbers cannot be mistaken for a late arrival: 32 ms are in flight.
constexpr std::size_t packets_in_frame = 242;
constexpr double packets_per_us = 30 * 242 / 1e6;
constexpr int sequence_range = 256;

bool is_empty(const UsbPacket& packet) { return packet.status == 0 && packet.bytes == 0; }

std::string line_of(const UsbPacket& packet) {
  if (packet.status != 0) {
    return "! " + std::to_string(packet.status) + "\n";
  }
  std::string line = std::to_string(packet.bytes) + " ";
  for (const std::uint8_t byte : packet.header) {
    line += digits[byte >> 4U];
    line += digits[byte & 0x0FU];
  }
  return line + "\n";
}

/// Reads the lines of a file, and counts them for its errors.
class Lines {
 public:
  explicit Lines(std::string_view text) : text_(text) {}

  std::string_view next() {
    const std::size_t end = text_.find('\n');
    ++number_;
    if (end == text_.npos) {
      refuse("it is cut off");
    }
    const std::string_view line = text_.substr(0, end);
    text_.remove_prefix(end + 1);
    return line;
  }

  bool is_at_end() const { return text_.empty(); }

  [[noreturn]] void refuse(const std::string& why) const {
    throw Error(ErrorCode::recording_malformed,
                "recording of USB, line " + std::to_string(number_) + ": " + why);
  }

  /// A whole number from `min` to `max`.
  std::int64_t number(std::string_view text, std::int64_t min, std::int64_t max) const {
    std::int64_t value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || end != text.data() + text.size() || value < min || value > max) {
      refuse("a whole number from " + std::to_string(min) + " to " + std::to_string(max) +
             " is expected");
    }
    return value;
  }

  std::array<std::uint8_t, 12> header(std::string_view text) const {
    std::array<std::uint8_t, 12> bytes = {};
    if (text.size() != 2 * bytes.size() || text.find_first_not_of(digits) != text.npos) {
      refuse("a header of 24 hexadecimal digits is expected");
    }
    for (std::size_t i = 0; i < bytes.size(); ++i) {
      bytes[i] =
          static_cast<std::uint8_t>(digits.find(text[2 * i]) << 4U | digits.find(text[2 * i + 1]));
    }
    return bytes;
  }

 private:
  std::string_view text_;
  int number_ = 0;
};

/// A packet that arrived with a header of the depth stream.
struct Arrival {
  std::int64_t time_us = 0;
  std::uint8_t sequence = 0;
  bool begins_frame = false;
};

std::optional<Arrival> arrival_of(const UsbPacket& packet) {
  const auto& header = packet.header;
  if (packet.status != 0 || packet.bytes <= header.size() || header[0] != 'R' || header[1] != 'B' ||
      (header[3] & 0xF0U) != 0x70) {
    return std::nullopt;
  }
  return Arrival{
      .time_us = packet.time_us, .sequence = header[5], .begins_frame = (header[3] & 0x0FU) == 1};
}

/// The number of packets lost between two that arrived one after the other.
std::size_t lost_between(const Arrival& before, const Arrival& after) {
  const int skipped = static_cast<std::uint8_t>(after.sequence - before.sequence - 1);
  const double due = static_cast<double>(after.time_us - before.time_us) * packets_per_us;
  const double turns = due > 2 * sequence_range ? std::round((due - skipped) / sequence_range) : 0;
  return static_cast<std::size_t>(skipped) + sequence_range * static_cast<std::size_t>(turns);
}

}  // namespace

std::string to_usb_log_text(std::span<const UsbPacket> packets,
                            std::span<const std::string> notes) {
  std::string text = std::string(first_line) + "\n";
  for (const std::string& note : notes) {
    text += "# " + note + "\n";
  }
  std::optional<std::int64_t> time;
  for (auto packet = packets.begin(); packet != packets.end();) {
    if (packet->time_us != time) {
      time = packet->time_us;
      text += "@ " + std::to_string(*time - packets.front().time_us) + "\n";
    }
    if (!is_empty(*packet)) {
      text += line_of(*packet++);
      continue;
    }
    const auto end = std::find_if(packet, packets.end(), [&](const UsbPacket& other) {
      return !is_empty(other) || other.time_us != *time;
    });
    text += ". " + std::to_string(end - packet) + "\n";
    packet = end;
  }
  return text + std::string(last_line) + "\n";
}

std::vector<UsbPacket> parse_usb_log(std::string_view text) {
  Lines lines(text);
  if (lines.next() != first_line) {
    lines.refuse("this is no file of octurn record --usb, or of a newer version");
  }
  std::vector<UsbPacket> packets;
  std::optional<std::int64_t> time;
  for (std::string_view line = lines.next(); line != last_line; line = lines.next()) {
    if (line.starts_with('#')) {
      continue;
    }
    const std::size_t space = std::min(line.find(' '), line.size());
    const std::string_view word = line.substr(0, space);
    const std::string_view rest = line.substr(std::min(space + 1, line.size()));
    if (word == "@") {
      time = lines.number(rest, time.value_or(0), max_time_us);
      continue;
    }
    if (!time) {
      lines.refuse("a time is expected before the first packet");
    }
    std::int64_t count = 1;
    UsbPacket packet{.time_us = *time};
    if (word == ".") {
      count = lines.number(rest, 1, max_logged_packets);
    } else if (word == "!") {
      packet.status = static_cast<std::uint16_t>(lines.number(rest, 1, 0xFFFF));
    } else {
      packet.bytes = static_cast<std::uint16_t>(lines.number(word, 1, 0xFFFF));
      packet.header = lines.header(rest);
    }
    if (packets.size() + static_cast<std::size_t>(count) > max_logged_packets) {
      lines.refuse("it has more than " + std::to_string(max_logged_packets) + " packets");
    }
    packets.insert(packets.end(), static_cast<std::size_t>(count), packet);
  }
  if (!lines.is_at_end()) {
    lines.refuse("something follows its end");
  }
  return packets;
}

std::vector<bool> lost_packets(std::span<const UsbPacket> packets) {
  std::vector<bool> lost;
  std::optional<Arrival> before;
  for (const UsbPacket& packet : packets) {
    const std::optional<Arrival> arrival = arrival_of(packet);
    if (!arrival || (!before && !arrival->begins_frame)) {
      continue;
    }
    if (before) {
      lost.insert(lost.end(), lost_between(*before, *arrival), true);
    }
    lost.push_back(false);
    before = arrival;
  }
  lost.resize(lost.size() / packets_in_frame * packets_in_frame);
  return lost;
}

}  // namespace octurn
