#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

// What arrived of a Kinect's depth stream over USB, packet by packet, without the depth itself: as
// the driver logs it, and as a file that `octurn record --usb` writes.

namespace octurn {

/// A microframe of USB has one packet, or none.
inline constexpr int microframes_per_second = 8000;
inline constexpr int max_usb_log_seconds = 60;
inline constexpr std::size_t max_logged_packets =
    std::size_t{max_usb_log_seconds} * microframes_per_second;
/// No such file has more: a packet takes up to 32 bytes, a time as much.
inline constexpr std::size_t max_usb_log_bytes = 64 * max_logged_packets;

/// What came in a microframe.
struct UsbPacket {
  std::int64_t time_us = 0;  ///< arrival of its transfer, which has several packets: steady clock
  std::uint16_t status = 0;  ///< a libusb_transfer_status; 0: completed
  std::uint16_t bytes = 0;   ///< received; 0: the microframe had no packet, or it failed
  std::array<std::uint8_t, 12> header = {};  ///< its first bytes, then zeros
  bool operator==(const UsbPacket&) const = default;
};

/// The file's text. Times become microseconds since the first packet; what came in a microframe
/// without a completed packet is left out.
/// @param notes  one line each, for its reader
std::string to_usb_log_text(std::span<const UsbPacket> packets, std::span<const std::string> notes);

/// @throws Error "recording-malformed"  with the number of the line that is wrong
std::vector<UsbPacket> parse_usb_log(std::string_view text);

/// Whether each packet of depth that the sensor sent was lost: from the beginning of the first
/// frame of which the first packet arrived to the end of the last whole one. A loss follows from
/// the sequence numbers of the packets around it, which count modulo 256, and if it took more than
/// twice that, from their times.
std::vector<bool> lost_packets(std::span<const UsbPacket> packets);

}  // namespace octurn
