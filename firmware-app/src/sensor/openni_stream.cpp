#include "sensor/openni_stream.hpp"

#include <cmath>
#include <cstddef>
#include <string>

#include "octurn/units.hpp"
#include "sensor/openni_library.hpp"

namespace octurn {

std::optional<double> depth_unit(const openni::VideoMode& mode) {
  switch (mode.getPixelFormat()) {
    case openni::PIXEL_FORMAT_DEPTH_100_UM:
      return metres_from_mm(0.1);
    case openni::PIXEL_FORMAT_DEPTH_1_MM:
      return metres_from_mm(1);
    default:
      return std::nullopt;
  }
}

Intrinsics to_intrinsics(const openni::VideoStream& stream) {
  const openni::VideoMode mode = stream.getVideoMode();
  const std::optional<double> unit = depth_unit(mode);
  if (!unit) {
    throw Error(ErrorCode::sensor_failed, "sensor: gives no depth in millimetres",
                "Use another sensor.");
  }
  const auto focal_length = [](int size, float field_of_view) {
    return size / (2 * std::tan(static_cast<double>(field_of_view) / 2));
  };
  const int width = mode.getResolutionX();
  const int height = mode.getResolutionY();
  return {.width = width,
          .height = height,
          .fx = focal_length(width, stream.getHorizontalFieldOfView()),
          .fy = focal_length(height, stream.getVerticalFieldOfView()),
          .cx = width / 2.0,
          .cy = height / 2.0,
          .depth_unit = *unit};
}

bool wait_for_frame(openni::VideoStream& stream, std::chrono::milliseconds timeout) {
  openni::VideoStream* waited_for = &stream;
  int ready = 0;
  return openni::OpenNI::waitForAnyStream(&waited_for, 1, &ready,
                                          static_cast<int>(timeout.count())) == openni::STATUS_OK;
}

openni::VideoFrameRef read_frame(openni::VideoStream& stream) {
  openni::VideoFrameRef frame;
  expect_ok(stream.readFrame(&frame), "read a frame");
  return frame;
}

Picture to_picture(const openni::VideoFrameRef& frame) {
  Picture copy{.width = frame.getWidth(), .height = frame.getHeight(), .samples = {}};
  const auto* row = static_cast<const std::uint8_t*>(frame.getData());
  for (int v = 0; v < copy.height; ++v) {
    copy.samples.insert(copy.samples.end(), row, row + copy.width);
    row += frame.getStrideInBytes();
  }
  return copy;
}

DepthFrame to_depth_frame(const openni::VideoFrameRef& frame) {
  DepthFrame copy = {.width = frame.getWidth(), .height = frame.getHeight()};
  copy.depth.reserve(static_cast<std::size_t>(copy.width) * static_cast<std::size_t>(copy.height));
  const auto* row = static_cast<const std::byte*>(frame.getData());
  for (int v = 0; v < copy.height; ++v) {
    const auto* const pixels = reinterpret_cast<const openni::DepthPixel*>(row);
    copy.depth.insert(copy.depth.end(), pixels, pixels + copy.width);
    row += frame.getStrideInBytes();
  }
  return copy;
}

Error silence_error(std::chrono::milliseconds silence, double lost_share) {
  const auto silent_ms = static_cast<double>(silence.count());
  if (lost_share > 0.1) {  // else it sent next to nothing
    return Error(
        ErrorCode::sensor_silent,
        "sensor: no usable frame for " + std::to_string(silence.count()) + " ms: " +
            std::to_string(std::lround(100 * lost_share)) + " % of its packets were lost on USB",
        "Plug the sensor directly into another USB port, and check its power supply and cable.",
        {{"lost_share", lost_share}, {"silent_ms", silent_ms}});
  }
  return Error(ErrorCode::sensor_silent,
               "sensor: no frame for " + std::to_string(silence.count()) + " ms",
               "Unplug the sensor, plug it in again, and retry.", {{"silent_ms", silent_ms}});
}

}  // namespace octurn
