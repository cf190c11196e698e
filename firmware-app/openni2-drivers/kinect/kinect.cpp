#include "kinect/kinect.hpp"

#include <algorithm>
#include <cmath>
#include <thread>

#include "kinect/usb_place.hpp"
#include "octurn/error.hpp"

namespace octurn {
namespace {

using std::chrono::steady_clock;
using namespace std::chrono_literals;

constexpr std::array<CameraRegister, 7> depth_start{
    {{0x105, 0}, {0x06, 0}, {0x12, 3}, {0x13, 1}, {0x14, 30}, {0x06, 2}, {0x17, 0}}};
// As libfreenect and the kernel's gspca_kinect do it.
constexpr std::array<CameraRegister, 7> infrared_start{
    {{0x105, 0}, {0x05, 0}, {0x19, 0}, {0x1A, 1}, {0x1B, 30}, {0x05, 3}, {0x48, 0}}};

/// Model 1414, whose motor answers without firmware.
constexpr std::uint16_t release_of_1414 = 0x010B;

constexpr auto opening_patience = 4s;
// An audio part vanishes for 2 s after a reset, and then has to be listed.
constexpr auto audio_patience = 3s;
constexpr auto audio_interval = 100ms;
constexpr auto motor_patience = 500ms;
// A stop request may come while the stream starts: together with the end of the transfers, 2 s.
constexpr auto starting_patience = 1s;
constexpr auto stopping_patience = 500ms;

/// The cameras of all Kinects, by bus and address.
std::vector<UsbPart> cameras_among(const std::vector<UsbPart>& parts) {
  std::vector<UsbPart> cameras;
  std::ranges::copy_if(parts, std::back_inserter(cameras), &UsbPart::is_camera);
  return cameras;
}

UsbPart camera_of(int index) {
  const std::vector<UsbPart> cameras = cameras_among(usb_parts());
  if (static_cast<std::size_t>(index) >= cameras.size()) {
    throw Error(ErrorCode::sensor_missing, "kinect: none is plugged in");
  }
  return cameras[static_cast<std::size_t>(index)];
}

/// Opens another part of a camera's Kinect, which is on the same hub; null if that fails: depth
/// works without it.
std::unique_ptr<UsbDevice> open_beside(const UsbPart& camera,
                                       bool (UsbPart::*is_wanted)() const) try {
  for (const UsbPart& part : usb_parts()) {
    if ((part.*is_wanted)() && part.bus == camera.bus && part.hub == camera.hub) {
      return std::make_unique<UsbDevice>(part);
    }
  }
  return nullptr;
} catch (const Error&) {
  return nullptr;
}

/// Waits for an audio part that is away: by its port the Kinect would be another one, without its
/// sensor map and its optics.
std::string serial_of(const UsbDevice& camera, const UsbPart& part, int index,
                      steady_clock::time_point deadline) {
  std::string serial = camera.serial();
  if (serial.empty()) {
    auto audio = open_beside(part, &UsbPart::is_audio);
    while (!audio && steady_clock::now() < deadline) {
      std::this_thread::sleep_for(audio_interval);
      audio = open_beside(part, &UsbPart::is_audio);
    }
    serial = audio ? audio->serial() : std::string();
  }
  return serial.empty() ? usb_place(index) : serial;
}

/// The accelerometer's axes are x to the left (seen from behind), y up and z forward; its counts
/// are big-endian from the third byte on. At rest its reading points up.
std::optional<Tilt> to_tilt(std::span<const std::uint8_t> state) {
  constexpr double counts_per_g = 819;  // KXSD9, at 2 g
  const auto counts = [&](std::size_t axis) {
    return static_cast<double>(
        static_cast<std::int16_t>(state[2 + 2 * axis] << 8U | state[3 + 2 * axis]));
  };
  const double left = counts(0);
  const double up = counts(1);
  const double forward = counts(2);
  if (std::hypot(left, up, forward) < counts_per_g / 2) {
    return std::nullopt;
  }
  return Tilt{.pitch = std::atan2(forward, std::hypot(left, up)), .roll = std::atan2(left, up)};
}

}  // namespace

constinit const CameraStream depth_camera{
    .endpoint = 0x82, .packets = depth_packets, .start = depth_start, .stop = {0x06, 0}};
constinit const CameraStream infrared_camera{
    .endpoint = 0x81, .packets = infrared_packets, .start = infrared_start, .stop = {0x05, 0}};

int Kinect::count() { return static_cast<int>(cameras_among(usb_parts()).size()); }

Kinect::Kinect(int index)
    : commands_(
          {.write = [this](auto data, auto timeout) { return camera_->write(0, data, timeout); },
           .read = [this](auto data, auto timeout) { return camera_->read(0, data, timeout); }}) {
  const auto begin = steady_clock::now();
  const UsbPart camera = camera_of(index);
  camera_ = std::make_unique<UsbDevice>(camera);
  parameters_ = commands_.parameters(begin + opening_patience);
  serial_ = serial_of(*camera_, camera, index, begin + audio_patience);
  has_near_mode_ = camera.is_for_windows();
  if (camera.release == release_of_1414) {
    motor_ = open_beside(camera, &UsbPart::is_motor);
  }
}

/// A motor that did not answer in time is not asked again: each question would take as long.
std::optional<Tilt> Kinect::tilt() {
  constexpr std::uint8_t state_request = 0x32;
  std::array<std::uint8_t, 10> state = {};
  const std::lock_guard lock(motor_mutex_);
  try {
    const int count = motor_ ? motor_->read(state_request, state, motor_patience) : 0;
    if (count == LIBUSB_ERROR_TIMEOUT) {
      motor_.reset();
    }
    return count == static_cast<int>(state.size()) ? to_tilt(state) : std::nullopt;
  } catch (const Error&) {
    motor_.reset();
    return std::nullopt;
  }
}

bool Kinect::set_near_mode(bool on) try {
  const Use used = use();
  if (!used) {
    return false;
  }
  // As libfreenect does it: the projector's brightness, a pause, and the range.
  const auto deadline = steady_clock::now() + opening_patience;
  commands_.write_register(0x15, on ? 0x07 : 0x1E, deadline);
  std::this_thread::sleep_for(100ms);
  commands_.write_register(0x02EF, on ? 0 : 0x0190, deadline);
  return true;
} catch (const Error&) {
  return false;
}

void Kinect::stream(Use /*use*/, const CameraStream& stream, const std::stop_token& stop,
                    const std::function<void(const RawFrame&)>& on_frame) {
  const PacketFormat& format = stream.packets;
  std::vector<std::uint16_t> readings(8 * format.frame_bytes / format.reading_bits);
  PacketFrames frames(format, [&](const ReceivedFrame& frame) {
    if (count_packets(frame, format)) {
      unpack_readings(frame, format, readings);
      on_frame({.readings = readings, .time = frame.begin});
    }
  });
  try {
    camera_->begin_stream(stream.endpoint, [&](const IsoPacket& packet) {
      log(packet);
      frames.take(packet.data, packet.time);
    });
    const auto deadline = steady_clock::now() + starting_patience;
    for (const auto& [address, value] : stream.start) {
      commands_.write_register(address, value, deadline);
    }
    while (!stop.stop_requested() && camera_->handle_events()) {
    }
    is_lost_ = !stop.stop_requested();
    commands_.write_register(stream.stop.address, stream.stop.value,
                             steady_clock::now() + stopping_patience);
  } catch (const Error&) {
    is_lost_ = true;
  }
  if (!camera_->end_stream()) {
    is_lost_ = true;
  }
}

/// @return whether enough of its packets arrived: 80 %
bool Kinect::count_packets(const ReceivedFrame& frame, const PacketFormat& format) {
  const auto lost = static_cast<int>(frame.lost.size());
  const bool is_enough = 5 * lost <= format.packets();
  const std::lock_guard lock(counts_mutex_);
  ++(lost == 0   ? counts_.whole_frames
     : is_enough ? counts_.partial_frames
                 : counts_.dropped_frames);
  counts_.packets += format.packets();
  counts_.lost_packets += lost;
  return is_enough;
}

PacketCounts Kinect::packet_counts() const {
  const std::lock_guard lock(counts_mutex_);
  return counts_;
}

/// All memory is taken now, and none by the stream's thread.
void Kinect::log_packets(std::size_t count) {
  const std::lock_guard lock(log_mutex_);
  log_.clear();
  log_.reserve(count);
  log_room_ = count;
}

std::size_t Kinect::take_logged(std::span<UsbPacket> packets) {
  const std::lock_guard lock(log_mutex_);
  const std::size_t count = std::min(log_.size(), packets.size());
  const auto end = log_.begin() + static_cast<std::ptrdiff_t>(count);
  std::copy(log_.begin(), end, packets.begin());
  log_.erase(log_.begin(), end);
  return count;
}

void Kinect::log(const IsoPacket& packet) {
  const std::lock_guard lock(log_mutex_);
  if (log_room_ == 0) {
    return;
  }
  --log_room_;
  UsbPacket& logged = log_.emplace_back();
  logged.time_us =
      std::chrono::duration_cast<std::chrono::microseconds>(packet.time.time_since_epoch()).count();
  logged.status = packet.status;
  logged.bytes = static_cast<std::uint16_t>(packet.data.size());
  std::copy_n(packet.data.begin(), std::min(packet.data.size(), logged.header.size()),
              logged.header.begin());
}

}  // namespace octurn
