#pragma once

#include <cstdint>
#include <optional>

namespace octurn {

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

}  // namespace octurn
