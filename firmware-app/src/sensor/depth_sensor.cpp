#include "sensor/depth_sensor.hpp"

#include <OpenNI.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <string_view>
#include <utility>

#include "kinect/kinect_device.hpp"
#include "log.hpp"
#include "octurn/error.hpp"
#include "octurn/units.hpp"
#include "simulator/simulation.hpp"

namespace octurn {
namespace {

using std::chrono::steady_clock;

/// A stop request is answered after this long at most, which is a frame.
constexpr std::chrono::milliseconds patience = std::chrono::milliseconds(33);
constexpr std::chrono::milliseconds longest_silence = std::chrono::milliseconds(2000);

constexpr const char* missing_hint =
    "Check that the sensor has its own power supply, that its USB plug sits firmly, and that its "
    "light is on.";

constexpr const char* simulation_hint =
    "Check the simulator's settings, and that its mesh is an STL or OBJ file in millimetres.";

/// Depth formats that Octurn reads, the finer first, with their units in metres.
struct DepthFormat {
  openni::PixelFormat format;
  double unit;
};
constexpr std::array<DepthFormat, 2> depth_formats = {
    DepthFormat{openni::PIXEL_FORMAT_DEPTH_100_UM, metres_from_mm(0.1)},
    DepthFormat{openni::PIXEL_FORMAT_DEPTH_1_MM, metres_from_mm(1)}};

/// What OpenNI2 and its drivers say about the last failure, on one line.
std::string last_words() {
  std::string words = openni::OpenNI::getExtendedError();
  for (char& letter : words) {
    letter = letter == '\n' || letter == '\t' ? ' ' : letter;
  }
  const std::size_t first = words.find_first_not_of(' ');
  return first == words.npos ? "" : words.substr(first, words.find_last_not_of(' ') + 1 - first);
}

void expect_ok(openni::Status status, const char* doing) {
  if (status != openni::STATUS_OK) {
    throw Error("sensor-failed", std::string("sensor: cannot ") + doing + ": " + last_words(),
                "Unplug the sensor, plug it in again, and retry.");
  }
}

/// OpenNI2's drivers, loaded once and for the whole run: loading them changes the working directory
/// of the process for a moment.
struct OpenNi {
  OpenNi() { expect_ok(openni::OpenNI::initialize(), "load OpenNI2's drivers"); }
  ~OpenNi() { openni::OpenNI::shutdown(); }
  OpenNi(const OpenNi&) = delete;
  OpenNi& operator=(const OpenNi&) = delete;
};

/// The first sensor that was there when OpenNI2 started, or else any Kinect, which may have been
/// plugged in since. A simulated sensor that was opened before is on OpenNI2's list too, but is
/// never meant.
std::string any_sensor() {
  openni::Array<openni::DeviceInfo> devices;
  openni::OpenNI::enumerateDevices(&devices);
  for (int i = 0; i < devices.getSize(); ++i) {
    std::string uri = devices[i].getUri();
    if (!uri.starts_with(simulator_scheme)) {
      return uri;
    }
  }
  return std::string(kinect_scheme);
}

void open(openni::Device& device, const std::string& uri) {
  if (device.open((uri.empty() ? any_sensor() : uri).c_str()) == openni::STATUS_OK) {
    return;
  }
  if (uri.starts_with(simulator_scheme)) {
    throw Error("sensor-failed", "sensor: " + last_words(), simulation_hint);
  }
  throw Error("sensor-missing", (uri.empty() ? "sensor: none found: " : "sensor: ") + last_words(),
              missing_hint);
}

/// Whether the device of that URI belongs to one of Octurn's own drivers.
bool is_octurns(std::string_view uri) {
  return uri.starts_with(simulator_scheme) || uri.starts_with(kinect_scheme);
}

/// The sensor's mode that suits a scan best: the finest unit, then the largest picture, then the
/// highest rate.
openni::VideoMode best_mode(const openni::VideoStream& stream) {
  const auto rank = [](const openni::VideoMode& mode) {
    const auto* format =
        std::ranges::find(depth_formats, mode.getPixelFormat(), &DepthFormat::format);
    return std::array<std::ptrdiff_t, 3>{
        depth_formats.end() - format, std::ptrdiff_t{mode.getResolutionX()} * mode.getResolutionY(),
        mode.getFps()};
  };
  const auto& modes = stream.getSensorInfo().getSupportedVideoModes();
  openni::VideoMode best = stream.getVideoMode();
  for (int i = 0; i < modes.getSize(); ++i) {
    if (rank(modes[i]) > rank(best)) {
      best = modes[i];
    }
  }
  return best;
}

Intrinsics intrinsics_of(const openni::VideoStream& stream) {
  const openni::VideoMode mode = stream.getVideoMode();
  const auto* format =
      std::ranges::find(depth_formats, mode.getPixelFormat(), &DepthFormat::format);
  if (format == depth_formats.end()) {
    throw Error("sensor-failed", "sensor: gives no depth in millimetres", "Use another sensor.");
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
          .depth_unit = format->unit};
}

/// A Kinect for Windows sees nothing nearer than 0.8 m unless it is in near mode, and a rig is
/// smaller.
void prepare_kinect(openni::Device& device) {
  if (device.isPropertySupported(near_mode_property)) {
    expect_ok(device.setProperty(near_mode_property, OniBool{TRUE}), "set its near mode");
  }
  if (std::string_view(device.getDeviceInfo().getUri()).starts_with(kinect_scheme) &&
      !device.isPropertySupported(tilt_property)) {
    log::info("sensor", "this Kinect tells no tilt: its model needs firmware for that");
  }
}

DepthFrame copy_of(const openni::VideoFrameRef& frame) {
  DepthFrame copy = {.width = frame.getWidth(), .height = frame.getHeight()};
  const auto row = static_cast<std::size_t>(copy.width);
  copy.depth.resize(row * static_cast<std::size_t>(copy.height));
  const auto* from = static_cast<const std::byte*>(frame.getData());
  for (std::size_t at = 0; at < copy.depth.size(); at += row) {
    std::memcpy(&copy.depth[at], from, row * sizeof copy.depth[at]);
    from += frame.getStrideInBytes();
  }
  return copy;
}

}  // namespace

void load_sensor_drivers() { static const OpenNi loaded; }

struct DepthSensor::Device {
  openni::Device device = {};
  openni::VideoStream stream = {};
  std::string name = {};
  Intrinsics intrinsics = {};
  bool keeps_steady_time = false;  // as drivers of Octurn do; others stamp by clocks of their own
  bool is_simulated = false;

  Device() = default;
  Device(const Device&) = delete;
  Device& operator=(const Device&) = delete;
  ~Device() {
    stream.destroy();
    device.close();
  }

  bool is_lost() const {
    int state = openni::DEVICE_STATE_OK;
    int size = sizeof state;
    return device.getProperty(ONI_DEVICE_PROPERTY_ERROR_STATE, &state, &size) ==
               openni::STATUS_OK &&
           state != openni::DEVICE_STATE_OK;
  }

  TimedFrame read_frame() {
    openni::VideoFrameRef frame;
    expect_ok(stream.readFrame(&frame), "read a frame");
    return {.frame = copy_of(frame),
            .time = keeps_steady_time
                        ? steady_clock::time_point(std::chrono::microseconds(frame.getTimestamp()))
                        : steady_clock::now()};
  }
};

DepthSensor::DepthSensor(const std::string& uri) {
  load_sensor_drivers();
  device_ = std::make_unique<Device>();
  open(device_->device, uri);
  openni::VideoStream& stream = device_->stream;
  expect_ok(stream.create(device_->device, openni::SENSOR_DEPTH), "find its depth stream");
  if (!device_->device.isFile()) {
    expect_ok(stream.setVideoMode(best_mode(stream)), "set its depth mode");
    expect_ok(stream.setMirroringEnabled(false), "have it not mirror its frames");
  }
  device_->intrinsics = intrinsics_of(stream);
  device_->name = device_->device.getDeviceInfo().getName();
  device_->keeps_steady_time = is_octurns(device_->device.getDeviceInfo().getUri());
  device_->is_simulated = device_->device.isPropertySupported(platform_angle_property);
  prepare_kinect(device_->device);
  expect_ok(stream.start(), "start its depth stream");
}

DepthSensor::~DepthSensor() = default;

const std::string& DepthSensor::name() const { return device_->name; }

const Intrinsics& DepthSensor::intrinsics() const { return device_->intrinsics; }

std::optional<TimedFrame> DepthSensor::read(const std::stop_token& stop) {
  const auto deadline = steady_clock::now() + longest_silence;
  openni::VideoStream* stream = &device_->stream;
  while (!stop.stop_requested()) {
    int ready = 0;
    if (openni::OpenNI::waitForAnyStream(&stream, 1, &ready, static_cast<int>(patience.count())) ==
        openni::STATUS_OK) {
      return device_->read_frame();
    }
    if (device_->is_lost()) {
      throw Error("sensor-lost", "sensor: " + name() + " is gone", missing_hint);
    }
    if (steady_clock::now() > deadline) {
      throw Error("sensor-silent",
                  "sensor: no frame for " + std::to_string(longest_silence.count()) + " ms",
                  "Unplug the sensor, plug it in again, and retry.");
    }
  }
  return std::nullopt;
}

std::optional<Tilt> DepthSensor::tilt() const {
  Tilt tilt;
  int size = sizeof tilt;
  return device_->device.getProperty(tilt_property, &tilt, &size) == openni::STATUS_OK
             ? std::optional(tilt)
             : std::nullopt;
}

void DepthSensor::show_angle(double angle) {
  if (device_->is_simulated) {
    expect_ok(device_->device.setProperty(platform_angle_property, angle),
              "turn what it simulates");
  }
}

}  // namespace octurn
