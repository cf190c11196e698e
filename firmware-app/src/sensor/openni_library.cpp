#include "sensor/openni_library.hpp"

#include <cmath>
#include <cstddef>

#include "octurn/units.hpp"
#include "rig/kinect_device.hpp"
#include "rig/simulation.hpp"
#include "sensor/depth_sensor.hpp"

namespace octurn {
namespace {

constexpr const char* simulation_hint =
    "Check the simulator's settings, and that its mesh is an STL file in millimetres.";

/// OpenNI2 copies the URI into its error text, and overflows that buffer of 1,024 bytes.
constexpr std::size_t max_uri_length = 512;

/// URI of the first sensor on OpenNI2's list, which is filled when OpenNI2 starts; else of any
/// Kinect, which may have been plugged in since. Skips simulated sensors: once opened, they stay on
/// the list.
std::string any_sensor() {
  openni::Array<openni::DeviceInfo> devices;
  openni::OpenNI::enumerateDevices(&devices);
  for (int i = 0; i < devices.getSize(); ++i) {
    std::string uri = devices[i].getUri();
    if (!is_simulated_sensor(uri)) {
      return uri;
    }
  }
  return std::string(kinect_scheme);
}

/// The last failure in the words of OpenNI2 and its drivers, on one line.
std::string openni_error_text() {
  std::string text = openni::OpenNI::getExtendedError();
  for (char& letter : text) {
    letter = letter == '\n' || letter == '\t' ? ' ' : letter;
  }
  const std::size_t first = text.find_first_not_of(' ');
  return first == text.npos ? "" : text.substr(first, text.find_last_not_of(' ') + 1 - first);
}

}  // namespace

void expect_ok(openni::Status status, const char* doing) {
  if (status != openni::STATUS_OK) {
    throw Error(ErrorCode::sensor_failed,
                std::string("sensor: cannot ") + doing + ": " + openni_error_text(),
                "Unplug the sensor, plug it in again, and retry.");
  }
}

void open_device(openni::Device& device, const std::string& uri) {
  if (uri.size() > max_uri_length) {
    throw Error(ErrorCode::sensor_missing,
                "sensor: an address of more than " + std::to_string(max_uri_length) +
                    " bytes: " + uri.substr(0, 40) + "...",
                missing_sensor_hint);
  }
  if (device.open((uri.empty() ? any_sensor() : uri).c_str()) == openni::STATUS_OK) {
    return;
  }
  if (is_simulated_sensor(uri)) {
    throw Error(ErrorCode::sensor_failed, "sensor: " + openni_error_text(), simulation_hint);
  }
  throw Error(ErrorCode::sensor_missing,
              (uri.empty() ? "no sensor was found: " : "sensor: ") + openni_error_text(),
              missing_sensor_hint);
}

/// Loading changes the working directory of the process for a moment. The drivers are never
/// unloaded: PSLink and PS1080, which come with OpenNI2, cancel their threads, and unloading unmaps
/// the code that these still run. Some exits of the program crashed by that (SIGSEGV).
void load_sensor_drivers() {
  [[maybe_unused]] static const bool loaded = [] {
    expect_ok(openni::OpenNI::initialize(), "load OpenNI2's drivers");
    return true;
  }();
}

std::string openni_version() {
  const openni::Version version = openni::OpenNI::getVersion();
  return std::to_string(version.major) + "." + std::to_string(version.minor) + "." +
         std::to_string(version.maintenance) + "." + std::to_string(version.build);
}

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
