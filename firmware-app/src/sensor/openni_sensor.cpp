#include <OpenNI.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <string_view>
#include <thread>
#include <utility>

#include "log.hpp"
#include "octurn/error.hpp"
#include "octurn/units.hpp"
#include "rig/kinect_device.hpp"
#include "rig/simulation.hpp"
#include "sensor/depth_sensor.hpp"
#include "sensor/frame_limiter.hpp"
#include "sensor/openni_library.hpp"

namespace octurn {
namespace {

using std::chrono::steady_clock;

/// The longest delay of a stop request: a frame's period.
constexpr std::chrono::milliseconds poll_interval = std::chrono::milliseconds(33);
/// Timeouts of a frame: by the sensor's clock; and of a file's player, which may hang.
constexpr std::chrono::milliseconds longest_silence = std::chrono::milliseconds(2000);
constexpr std::chrono::milliseconds longest_file_read = std::chrono::seconds(30);
/// Sleep of OpenNI2's file player while no stream is started.
constexpr std::chrono::milliseconds player_pause = std::chrono::milliseconds(10);

/// Depth formats that Octurn reads, the finest first, with their units in metres.
struct DepthFormat {
  openni::PixelFormat format;
  double unit;
};
constexpr std::array<DepthFormat, 2> depth_formats = {
    DepthFormat{openni::PIXEL_FORMAT_DEPTH_100_UM, metres_from_mm(0.1)},
    DepthFormat{openni::PIXEL_FORMAT_DEPTH_1_MM, metres_from_mm(1)}};

/// Whether a device's driver is one of Octurn's, whose frames have timestamps of the steady clock.
bool has_octurns_driver(std::string_view uri) {
  return uri.starts_with(simulator_scheme) || uri.starts_with(kinect_scheme);
}

/// The sensor's best mode for a scan: the finest unit, then the largest picture, then the highest
/// rate.
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

Intrinsics to_intrinsics(const openni::VideoStream& stream) {
  const openni::VideoMode mode = stream.getVideoMode();
  const auto* format =
      std::ranges::find(depth_formats, mode.getPixelFormat(), &DepthFormat::format);
  if (format == depth_formats.end()) {
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
          .depth_unit = format->unit};
}

/// Sets near mode on a Kinect for Windows: without it depth begins at 0.8 m, and a rig is
/// smaller.
void prepare_kinect(openni::Device& device) {
  if (device.isPropertySupported(near_mode_property)) {
    expect_ok(device.setProperty(near_mode_property, OniBool{TRUE}), "set its near mode");
  }
  if (std::string_view(device.getDeviceInfo().getUri()).starts_with(kinect_scheme) &&
      !device.isPropertySupported(tilt_property)) {
    log::info("sensor", "this Kinect reports no tilt: its model needs firmware for that");
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

DepthFrame to_depth_frame(const openni::VideoFrameRef& frame) {
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

class OpenNiSensor final : public DepthSensor {
 public:
  explicit OpenNiSensor(std::string uri) : uri_(std::move(uri)) {
    load_sensor_drivers();
    open_stream();
    intrinsics_ = to_intrinsics(stream_);
    name_ = device_.getDeviceInfo().getName();
    has_steady_stamps_ = has_octurns_driver(device_.getDeviceInfo().getUri());
    is_simulated_ = device_.isPropertySupported(platform_angle_property);
  }
  ~OpenNiSensor() override { close(); }
  OpenNiSensor(const OpenNiSensor&) = delete;
  OpenNiSensor& operator=(const OpenNiSensor&) = delete;

  const std::string& name() const override { return name_; }
  const Intrinsics& intrinsics() const override { return intrinsics_; }
  std::string serial() const override;
  std::optional<TimedFrame> read(const std::stop_token& stop) override;
  std::optional<Tilt> tilt() const override;
  std::optional<int> damaged_frames() const override;
  void show_angle(double angle) override { simulate(platform_angle_property, angle); }
  void show_wall(std::optional<double> distance) override {
    simulate(wall_property, distance.value_or(0));
  }
  void set_object_pose(int pose) override { simulate(object_pose_property, pose); }

 private:
  void simulate(int property, double value);
  void open_stream();
  void prepare_file();
  void close();
  bool is_lost() const;
  TimedFrame take_frame();
  std::chrono::duration<double> sensor_time() const;

  std::string uri_;
  openni::Device device_ = {};
  openni::VideoStream stream_ = {};
  std::string name_ = {};
  Intrinsics intrinsics_ = {};
  bool has_steady_stamps_ = false;  // other drivers stamp frames by clocks of their own
  bool is_simulated_ = false;
  int frames_left_ = 0;        // of a file
  FrameLimiter limiter_ = {};  // of a file
};

void OpenNiSensor::open_stream() {
  open_device(device_, uri_);
  expect_ok(stream_.create(device_, openni::SENSOR_DEPTH), "find its depth stream");
  if (device_.isFile()) {
    prepare_file();
  } else {
    expect_ok(stream_.setVideoMode(best_mode(stream_)), "set its depth mode");
    expect_ok(stream_.setMirroringEnabled(false), "switch off its mirroring");
    prepare_kinect(device_);
  }
  expect_ok(stream_.start(), "start its depth stream");
}

/// Makes OpenNI2 read each frame of a file on demand and skip none.
void OpenNiSensor::prepare_file() {
  openni::PlaybackControl* playback = device_.getPlaybackControl();
  expect_ok(playback->setSpeed(-1), "read it frame by frame");
  expect_ok(playback->setRepeatEnabled(false), "read it once");
  frames_left_ = playback->getNumberOfFrames(stream_);
  if (frames_left_ <= 0) {
    throw Error(ErrorCode::sensor_failed, uri_ + ": has no depth frame");
  }
  if (stream_.getMirroringEnabled()) {
    throw Error(ErrorCode::sensor_failed, uri_ + ": its frames are mirrored",
                "Record it again without mirroring.");
  }
}

/// After the last frame OpenNI2's file player keeps iterating over its streams without a lock. With
/// no stream started it sleeps 10 ms between two iterations: the stream is destroyed meanwhile.
void OpenNiSensor::close() {
  if (device_.isFile()) {
    stream_.stop();
    std::this_thread::sleep_for(player_pause / 2);
  }
  stream_.destroy();
  device_.close();
}

bool OpenNiSensor::is_lost() const {
  int state = openni::DEVICE_STATE_OK;
  int size = sizeof state;
  return device_.getProperty(ONI_DEVICE_PROPERTY_ERROR_STATE, &state, &size) == openni::STATUS_OK &&
         state != openni::DEVICE_STATE_OK;
}

TimedFrame OpenNiSensor::take_frame() {
  openni::VideoFrameRef frame;
  expect_ok(stream_.readFrame(&frame), "read a frame");
  --frames_left_;
  return {.frame = to_depth_frame(frame),
          .time = has_steady_stamps_
                      ? steady_clock::time_point(std::chrono::microseconds(frame.getTimestamp()))
                      : steady_clock::now()};
}

/// A simulated sensor's own clock; for others, the steady clock.
std::chrono::duration<double> OpenNiSensor::sensor_time() const {
  const auto simulated = property_of<double>(device_, sensor_time_property);
  return simulated ? std::chrono::duration<double>(*simulated)
                   : steady_clock::now().time_since_epoch();
}

/// A file restarts after its last frame. It is opened again for that, because seeking in a file
/// crashes OpenNI2 2.2.0.33.
std::optional<TimedFrame> OpenNiSensor::read(const std::stop_token& stop) {
  if (device_.isFile()) {
    if (frames_left_ == 0) {
      close();
      open_stream();
    }
    if (!limiter_.wait(stop)) {
      return std::nullopt;
    }
  }
  const auto longest = device_.isFile() ? longest_file_read : longest_silence;
  const auto begin = sensor_time();
  openni::VideoStream* stream = &stream_;
  while (!stop.stop_requested()) {
    // Measured before the wait: a frame that has arrived is read, however late this thread wakes.
    const auto silence = sensor_time() - begin;
    int ready = 0;
    if (openni::OpenNI::waitForAnyStream(
            &stream, 1, &ready, static_cast<int>(poll_interval.count())) == openni::STATUS_OK) {
      return take_frame();
    }
    if (is_lost()) {
      throw Error(ErrorCode::sensor_lost, "sensor: " + name() + " is gone", missing_sensor_hint);
    }
    if (silence > longest) {
      throw Error(ErrorCode::sensor_silent,
                  "sensor: no frame for " + std::to_string(longest.count()) + " ms",
                  "Unplug the sensor, plug it in again, and retry.",
                  {{"silent_ms", static_cast<double>(longest.count())}});
    }
  }
  return std::nullopt;
}

std::optional<Tilt> OpenNiSensor::tilt() const { return property_of<Tilt>(device_, tilt_property); }

/// Without a serial number the URI identifies the sensor: OpenNI2 puts its USB port there.
std::string OpenNiSensor::serial() const {
  std::array<char, ONI_MAX_STR> text = {};
  int size = sizeof text;
  if (device_.isFile()) {
    return {};
  }
  if (device_.getProperty(ONI_DEVICE_PROPERTY_SERIAL_NUMBER, text.data(), &size) ==
          openni::STATUS_OK &&
      text.front() != '\0') {
    return {text.data(), ::strnlen(text.data(), text.size())};
  }
  return device_.getDeviceInfo().getUri();
}

std::optional<int> OpenNiSensor::damaged_frames() const {
  return property_of<int>(device_, damaged_frames_property);
}

void OpenNiSensor::simulate(int property, double value) {
  if (is_simulated_) {
    expect_ok(device_.setProperty(property, value), "change what it simulates");
  }
}

}  // namespace

std::unique_ptr<DepthSensor> open_openni_sensor(const std::string& uri) {
  return std::make_unique<OpenNiSensor>(uri);
}

}  // namespace octurn
