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
#include "sensor/pace.hpp"
#include "sensor/sensor_device.hpp"
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

/// The value of a device's property, if it has it.
template <typename Value>
std::optional<Value> property_of(const openni::Device& device, int property) {
  Value value{};
  int size = sizeof value;
  return device.getProperty(property, &value, &size) == openni::STATUS_OK ? std::optional(value)
                                                                          : std::nullopt;
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

class OpenNiDevice final : public SensorDevice {
 public:
  explicit OpenNiDevice(std::string uri) : uri_(std::move(uri)) {
    load_sensor_drivers();
    open_stream();
    intrinsics_ = intrinsics_of(stream_);
    name_ = device_.getDeviceInfo().getName();
    keeps_steady_time_ = is_octurns(device_.getDeviceInfo().getUri());
    is_simulated_ = device_.isPropertySupported(platform_angle_property);
  }
  ~OpenNiDevice() override { close(); }
  OpenNiDevice(const OpenNiDevice&) = delete;
  OpenNiDevice& operator=(const OpenNiDevice&) = delete;

  const std::string& name() const override { return name_; }
  const Intrinsics& intrinsics() const override { return intrinsics_; }
  std::optional<TimedFrame> read(const std::stop_token& stop) override;
  std::optional<Tilt> tilt() const override;
  std::optional<int> damaged_frames() const override;
  void show_angle(double angle) override;

 private:
  void open_stream();
  void prepare_file();
  void close();
  bool is_lost() const;
  TimedFrame take_frame();

  std::string uri_;
  openni::Device device_ = {};
  openni::VideoStream stream_ = {};
  std::string name_ = {};
  Intrinsics intrinsics_ = {};
  bool keeps_steady_time_ = false;  // as drivers of Octurn do; others stamp by clocks of their own
  bool is_simulated_ = false;
  int frames_left_ = 0;  // of a file
  Pace pace_ = {};       // of a file
};

void OpenNiDevice::open_stream() {
  open(device_, uri_);
  expect_ok(stream_.create(device_, openni::SENSOR_DEPTH), "find its depth stream");
  if (device_.isFile()) {
    prepare_file();
  } else {
    expect_ok(stream_.setVideoMode(best_mode(stream_)), "set its depth mode");
    expect_ok(stream_.setMirroringEnabled(false), "have it not mirror its frames");
    prepare_kinect(device_);
  }
  expect_ok(stream_.start(), "start its depth stream");
}

/// Each frame of a file is read when it is asked for, and none is passed over.
void OpenNiDevice::prepare_file() {
  openni::PlaybackControl* playback = device_.getPlaybackControl();
  expect_ok(playback->setSpeed(-1), "read it frame by frame");
  expect_ok(playback->setRepeatEnabled(false), "read it once");
  frames_left_ = playback->getNumberOfFrames(stream_);
  if (frames_left_ <= 0) {
    throw Error("sensor-failed", uri_ + ": has no depth frame");
  }
  if (stream_.getMirroringEnabled()) {
    throw Error("sensor-failed", uri_ + ": its frames are mirrored",
                "Record it again without mirroring.");
  }
}

void OpenNiDevice::close() {
  stream_.destroy();
  device_.close();
}

bool OpenNiDevice::is_lost() const {
  int state = openni::DEVICE_STATE_OK;
  int size = sizeof state;
  return device_.getProperty(ONI_DEVICE_PROPERTY_ERROR_STATE, &state, &size) == openni::STATUS_OK &&
         state != openni::DEVICE_STATE_OK;
}

TimedFrame OpenNiDevice::take_frame() {
  openni::VideoFrameRef frame;
  expect_ok(stream_.readFrame(&frame), "read a frame");
  --frames_left_;
  return {.frame = copy_of(frame),
          .time = keeps_steady_time_
                      ? steady_clock::time_point(std::chrono::microseconds(frame.getTimestamp()))
                      : steady_clock::now()};
}

/// A file begins again after its last frame. It is opened anew for that: to seek in one crashes
/// OpenNI2 2.2.0.33.
std::optional<TimedFrame> OpenNiDevice::read(const std::stop_token& stop) {
  if (device_.isFile()) {
    if (frames_left_ == 0) {
      close();
      open_stream();
    }
    if (!pace_.wait(stop)) {
      return std::nullopt;
    }
  }
  const auto deadline = steady_clock::now() + longest_silence;
  openni::VideoStream* stream = &stream_;
  while (!stop.stop_requested()) {
    int ready = 0;
    if (openni::OpenNI::waitForAnyStream(&stream, 1, &ready, static_cast<int>(patience.count())) ==
        openni::STATUS_OK) {
      return take_frame();
    }
    if (is_lost()) {
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

std::optional<Tilt> OpenNiDevice::tilt() const { return property_of<Tilt>(device_, tilt_property); }

std::optional<int> OpenNiDevice::damaged_frames() const {
  return property_of<int>(device_, damaged_frames_property);
}

void OpenNiDevice::show_angle(double angle) {
  if (is_simulated_) {
    expect_ok(device_.setProperty(platform_angle_property, angle), "turn what it simulates");
  }
}

}  // namespace

void load_sensor_drivers() { static const OpenNi loaded; }

std::string openni_version() {
  const openni::Version version = openni::OpenNI::getVersion();
  return std::to_string(version.major) + "." + std::to_string(version.minor) + "." +
         std::to_string(version.maintenance) + "." + std::to_string(version.build);
}

std::unique_ptr<SensorDevice> open_openni_device(const std::string& uri) {
  return std::make_unique<OpenNiDevice>(uri);
}

}  // namespace octurn
