#include <OpenNI.h>

#include <array>
#include <cstring>
#include <filesystem>
#include <limits>
#include <string>
#include <string_view>
#include <system_error>
#include <tuple>
#include <vector>

#include "log.hpp"
#include "octurn/error.hpp"
#include "rig/kinect_device.hpp"
#include "rig/simulation.hpp"
#include "sensor/depth_sensor.hpp"
#include "sensor/openni_library.hpp"
#include "sensor/packet_logger.hpp"

namespace octurn {
namespace {

using std::chrono::steady_clock;

/// The longest delay of a stop request: a frame's period.
constexpr std::chrono::milliseconds poll_interval = std::chrono::milliseconds(33);
/// A frame's timeout by the sensor's clock.
constexpr std::chrono::milliseconds longest_silence = std::chrono::milliseconds(2000);

/// Whether a device's driver is one of Octurn's, whose frames have timestamps of the steady clock.
bool has_octurns_driver(std::string_view uri) {
  return uri.starts_with(simulator_scheme) || uri.starts_with(kinect_scheme);
}

/// The sensor's best mode for a scan: the finest unit, then the largest picture, then the highest
/// rate.
openni::VideoMode best_mode(const openni::VideoStream& stream) {
  const auto rank = [](const openni::VideoMode& mode) {
    constexpr double unreadable = std::numeric_limits<double>::infinity();
    return std::tuple(-depth_unit(mode).value_or(unreadable),
                      mode.getResolutionX() * mode.getResolutionY(), mode.getFps());
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

/// Makes pixels without readings of those that the Kinect's driver marked as lost, and lists them.
std::vector<std::size_t> take_lost(DepthFrame& frame) {
  std::vector<std::size_t> lost;
  for (std::size_t i = 0; i < frame.depth.size(); ++i) {
    if (frame.depth[i] == lost_depth) {
      frame.depth[i] = 0;
      lost.push_back(i);
    }
  }
  return lost;
}

/// Fills the pixels of lost packets with those above and below: black stripes of two rows and more
/// would move the corners of a board. A picture has pixels, since not all packets are lost.
void fill_lost(Picture& picture) {
  const auto sample = [&](int u, int v) -> std::uint8_t& {
    return picture.samples[static_cast<std::size_t>(v) * static_cast<std::size_t>(picture.width) +
                           static_cast<std::size_t>(u)];
  };
  for (int u = 0; u < picture.width; ++u) {
    int above = -1;  // the last row with a sample
    for (int v = 0; v <= picture.height; ++v) {
      const bool is_end = v == picture.height;
      if (!is_end && sample(u, v) == lost_infrared) {
        continue;
      }
      for (int row = above + 1; row < v && !(is_end && above < 0); ++row) {
        const int upper = above < 0 ? sample(u, v) : sample(u, above);
        const int lower = is_end ? upper : sample(u, v);
        sample(u, row) =
            static_cast<std::uint8_t>(upper + (lower - upper) * (row - above) / (v - above));
      }
      above = v;
    }
  }
}

class OpenNiSensor final : public DepthSensor, public PacketLogger {
 public:
  explicit OpenNiSensor(const std::string& uri) {
    load_sensor_drivers();
    open_stream(uri);
    intrinsics_ = to_intrinsics(stream_);
    infrared_mode_ = find_infrared_mode();
    name_ = device_.getDeviceInfo().getName();
    has_steady_stamps_ = has_octurns_driver(device_.getDeviceInfo().getUri());
    is_simulated_ = device_.isPropertySupported(platform_angle_property);
    counts_packets_ = device_.isPropertySupported(packet_counts_property);
  }

  const std::string& name() const override { return name_; }
  const Intrinsics& intrinsics() const override { return intrinsics_; }
  std::string serial() const override;
  std::optional<TimedFrame> read(const std::stop_token& stop) override;
  bool has_infrared() const override { return infrared_mode_.has_value(); }
  std::optional<Picture> read_infrared(const std::stop_token& stop) override;
  std::optional<Tilt> tilt() const override;
  std::optional<PacketCounts> packet_counts() const override;
  bool log_packets(int count) override;
  std::vector<UsbPacket> take_logged_packets() override;
  void show_angle(double angle) override { simulate(platform_angle_property, angle); }
  void show_wall(std::optional<double> distance) override {
    simulate(wall_property, distance.value_or(0));
  }
  void show_board(int hold) override { simulate(board_property, hold); }
  void set_object_pose(int pose) override { simulate(object_pose_property, pose); }

 private:
  void simulate(int property, double value);
  void open_stream(const std::string& uri);
  std::optional<openni::VideoMode> find_infrared_mode();
  void show_depth();
  void show_infrared();
  bool wait_for(openni::VideoStream& stream, const std::stop_token& stop);
  bool is_lost() const;
  TimedFrame take_frame();
  std::chrono::duration<double> sensor_time() const;

  openni::Device device_ = {};
  openni::VideoStream stream_ = {};
  std::optional<openni::VideoMode> infrared_mode_ = {};
  openni::VideoStream infrared_ = {};  // created for the first infrared picture
  bool shows_infrared_ = false;        // in place of depth: one stream at a time
  std::string name_ = {};
  Intrinsics intrinsics_ = {};
  bool has_steady_stamps_ = false;  // other drivers stamp frames by clocks of their own
  bool is_simulated_ = false;
  bool counts_packets_ = false;  // and marks pixels that were lost
};

void OpenNiSensor::open_stream(const std::string& uri) {
  open_device(device_, uri);
  expect_ok(stream_.create(device_, openni::SENSOR_DEPTH), "find its depth stream");
  expect_ok(stream_.setVideoMode(best_mode(stream_)), "set its depth mode");
  expect_ok(stream_.setMirroringEnabled(false), "switch off its mirroring");
  prepare_kinect(device_);
  expect_ok(stream_.start(), "start its depth stream");
}

bool OpenNiSensor::is_lost() const {
  int state = openni::DEVICE_STATE_OK;
  int size = sizeof state;
  return device_.getProperty(ONI_DEVICE_PROPERTY_ERROR_STATE, &state, &size) == openni::STATUS_OK &&
         state != openni::DEVICE_STATE_OK;
}

TimedFrame OpenNiSensor::take_frame() {
  const openni::VideoFrameRef frame = read_frame(stream_);
  TimedFrame taken{.frame = to_depth_frame(frame),
                   .time = has_steady_stamps_ ? steady_clock::time_point(
                                                    std::chrono::microseconds(frame.getTimestamp()))
                                              : steady_clock::now()};
  if (counts_packets_) {
    taken.lost = take_lost(taken.frame);
  }
  return taken;
}

/// A simulated sensor's own clock; for others, the steady clock.
std::chrono::duration<double> OpenNiSensor::sensor_time() const {
  const auto simulated = property_of<double>(device_, sensor_time_property);
  return simulated ? std::chrono::duration<double>(*simulated)
                   : steady_clock::now().time_since_epoch();
}

/// Finds the mode of 8-bit pictures of the depth frames' size.
std::optional<openni::VideoMode> OpenNiSensor::find_infrared_mode() {
  const openni::SensorInfo* const camera = device_.getSensorInfo(openni::SENSOR_IR);
  if (camera == nullptr) {
    return std::nullopt;
  }
  const auto& modes = camera->getSupportedVideoModes();
  for (int i = 0; i < modes.getSize(); ++i) {
    if (modes[i].getPixelFormat() == openni::PIXEL_FORMAT_GRAY8 &&
        modes[i].getResolutionX() == intrinsics_.width &&
        modes[i].getResolutionY() == intrinsics_.height) {
      return modes[i];
    }
  }
  return std::nullopt;
}

void OpenNiSensor::show_depth() {
  if (shows_infrared_) {
    infrared_.stop();
    shows_infrared_ = false;
    expect_ok(stream_.start(), "start its depth stream");
  }
}

void OpenNiSensor::show_infrared() {
  if (shows_infrared_) {
    return;
  }
  if (!infrared_.isValid()) {
    if (!infrared_mode_) {
      DepthSensor::read_infrared({});  // throws
    }
    expect_ok(infrared_.create(device_, openni::SENSOR_IR), "find its infrared stream");
    expect_ok(infrared_.setVideoMode(*infrared_mode_), "set its infrared mode");
    expect_ok(infrared_.setMirroringEnabled(false), "switch off its mirroring");
  }
  stream_.stop();
  shows_infrared_ = true;
  if (infrared_.start() != openni::STATUS_OK) {
    show_depth();
    throw Error(ErrorCode::sensor_failed, "sensor: does not start its infrared stream",
                "Unplug the sensor, and plug it in again.");
  }
}

/// @return false if a stop was requested first
bool OpenNiSensor::wait_for(openni::VideoStream& stream, const std::stop_token& stop) {
  const auto begin = sensor_time();
  const auto counted = packet_counts();
  while (!stop.stop_requested()) {
    // Measured before the wait: a frame that has arrived is read, however late this thread wakes.
    const auto silence = sensor_time() - begin;
    if (wait_for_frame(stream, poll_interval)) {
      return true;
    }
    if (is_lost()) {
      throw Error(ErrorCode::sensor_lost, "sensor: " + name() + " is gone", missing_sensor_hint);
    }
    if (silence > longest_silence) {
      throw silence_error(longest_silence, lost_share(counted, packet_counts()));
    }
  }
  return false;
}

std::optional<TimedFrame> OpenNiSensor::read(const std::stop_token& stop) {
  show_depth();
  return wait_for(stream_, stop) ? std::optional(take_frame()) : std::nullopt;
}

std::optional<Picture> OpenNiSensor::read_infrared(const std::stop_token& stop) {
  show_infrared();
  if (!wait_for(infrared_, stop)) {
    return std::nullopt;
  }
  Picture picture = to_picture(read_frame(infrared_));
  if (counts_packets_) {
    fill_lost(picture);
  }
  return picture;
}

std::optional<Tilt> OpenNiSensor::tilt() const { return property_of<Tilt>(device_, tilt_property); }

/// Without a serial number the URI identifies the sensor: OpenNI2 puts its USB port there.
std::string OpenNiSensor::serial() const {
  std::array<char, ONI_MAX_STR> text = {};
  int size = sizeof text;
  if (device_.getProperty(ONI_DEVICE_PROPERTY_SERIAL_NUMBER, text.data(), &size) ==
          openni::STATUS_OK &&
      text.front() != '\0') {
    return {text.data(), ::strnlen(text.data(), text.size())};
  }
  return device_.getDeviceInfo().getUri();
}

std::optional<PacketCounts> OpenNiSensor::packet_counts() const {
  return property_of<PacketCounts>(device_, packet_counts_property);
}

bool OpenNiSensor::log_packets(int count) {
  return device_.isPropertySupported(usb_log_property) &&
         device_.setProperty(usb_log_property, count) == openni::STATUS_OK;
}

std::vector<UsbPacket> OpenNiSensor::take_logged_packets() {
  std::vector<UsbPacket> packets(max_logged_packets);
  int size = static_cast<int>(packets.size() * sizeof packets[0]);
  if (device_.getProperty(usb_log_property, packets.data(), &size) != openni::STATUS_OK) {
    return {};
  }
  packets.resize(static_cast<std::size_t>(size) / sizeof packets[0]);
  return packets;
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

std::unique_ptr<DepthSensor> open_sensor(const std::string& uri) {
  std::error_code unreadable;  // OpenNI2 then says that there is no such device
  if (std::filesystem::is_directory(uri, unreadable)) {
    return open_recording(uri);
  }
  return std::filesystem::is_regular_file(uri, unreadable) ? open_oni_file(uri)
                                                           : open_openni_sensor(uri);
}

}  // namespace octurn
