// The interface between the program and Octurn's Kinect driver: its URIs and its OpenNI2
// properties.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

namespace octurn {

/// URI scheme of Kinects. Alone it names the first Kinect found; followed by a number
/// (`kinect://1`), the Kinect of that index, counted from 0.
inline constexpr std::string_view kinect_scheme = "kinect://";

/// Property of type Tilt, from the Kinect's accelerometer. Models 1473 and for Windows do not
/// support it: their accelerometer needs firmware that Octurn may not ship.
inline constexpr int tilt_property = 0x4F430011;

/// Property of type OniBool: depth begins at 0.4 m instead of 0.8 m. Only a Kinect for Windows has
/// it, and it is set before the stream starts.
inline constexpr int near_mode_property = 0x4F430012;

/// Property of type PacketCounts: what arrived since the device was opened.
inline constexpr int packet_counts_property = 0x4F430013;

/// Set, type int: the driver logs so many packets of the stream from now on, and no more than
/// `max_logged_packets`. Read: takes from the log as many UsbPackets as fit, the oldest first.
inline constexpr int usb_log_property = 0x4F430014;

/// The SCHED_FIFO priority of the thread that takes the packets: above the reconstruction's, which
/// keeps all processors busy, and below the stepper's (`real_time_priority`). A late pulse costs
/// steps, and a late packet readings.
inline constexpr int usb_thread_priority = 30;

/// The depth of a pixel whose packet was lost. No reading's depth is that large.
inline constexpr std::uint16_t lost_depth = 65535;

/// The grey level of a pixel of an infrared picture whose packet was lost. All others are at least
/// 1.
inline constexpr std::uint8_t lost_infrared = 0;

/// What arrived of a sensor's stream over USB, since the sensor was opened.
struct PacketCounts {
  std::int64_t whole_frames = 0;
  std::int64_t partial_frames = 0;  ///< delivered, although packets were lost
  std::int64_t dropped_frames = 0;  ///< too many packets were lost
  std::int64_t packets = 0;         ///< of all these frames
  std::int64_t lost_packets = 0;    ///< of them

  double lost_share() const {
    return packets > 0 ? static_cast<double>(lost_packets) / static_cast<double>(packets) : 0;
  }
  bool operator==(const PacketCounts&) const = default;
};

/// What arrived between two counts.
inline PacketCounts operator-(const PacketCounts& later, const PacketCounts& earlier) {
  return {.whole_frames = later.whole_frames - earlier.whole_frames,
          .partial_frames = later.partial_frames - earlier.partial_frames,
          .dropped_frames = later.dropped_frames - earlier.dropped_frames,
          .packets = later.packets - earlier.packets,
          .lost_packets = later.lost_packets - earlier.lost_packets};
}

/// The share of packets that were lost between two counts; 0 where the sensor counts none.
inline double lost_share(const std::optional<PacketCounts>& before,
                         const std::optional<PacketCounts>& after) {
  return before && after ? (*after - *before).lost_share() : 0;
}

/// A sensor's attitude against gravity, from its accelerometer.
struct Tilt {
  double pitch = 0;  ///< radians, positive when the sensor looks up
  double roll = 0;   ///< radians, positive when the right side, seen from behind, is lower
};

}  // namespace octurn
