#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "kinect/kinect_on_desk.hpp"
#include "sensor/depth_sensor.hpp"

namespace octurn {

inline constexpr std::size_t frame_pixels = std::size_t{640} * 480;

inline Readings frame_of(std::uint16_t reading) { return Readings(frame_pixels, reading); }

/// Distinguishable frames: each consists of a single reading of its own.
inline std::vector<Readings> plain_frames(int count) {
  std::vector<Readings> frames;
  for (int i = 0; i < count; ++i) {
    frames.push_back(frame_of(static_cast<std::uint16_t>(600 + i)));
  }
  return frames;
}

/// Depth of a raw reading, units of 0.1 mm: z = 345489 / (1089.40 - reading) mm.
inline double depth_of(int reading) { return 3454890 / (1089.40 - reading); }

inline DepthFrame next_frame(DepthSensor& sensor) { return sensor.read({}).value().frame; }

}  // namespace octurn
