#include "kinect/kinect.hpp"

#include <libfreenect_registration.h>
#include <sys/time.h>

#include <cmath>
#include <cstring>

#include "kinect/freenect_log.hpp"
#include "octurn/error.hpp"

namespace octurn {
namespace {

using std::chrono::steady_clock;

constexpr std::size_t pixels = std::size_t{640} * 480;
constexpr int frame_bytes = static_cast<int>(pixels) * 11 / 8;
constexpr int packet_bytes = 1748;  // payload of every packet but the last; the header has 12 more
constexpr int packets = (frame_bytes + packet_bytes - 1) / packet_bytes;

constexpr auto tilt_interval = std::chrono::seconds(1);
constexpr timeval patience = {.tv_sec = 0, .tv_usec = 20'000};  // a stop request waits no longer

/// Whether the result of handling USB events says that the device is lost. A signal that interrupts
/// the wait, as when the program is stopped and continued, loses nothing.
bool is_loss(int result) {
  constexpr int interrupted = -10;  // LIBUSB_ERROR_INTERRUPTED, which libfreenect passes on
  return result < 0 && result != interrupted;
}

int bytes_of_packet(int number) {
  return number + 1 < packets ? packet_bytes : frame_bytes - number * packet_bytes;
}

bool is_sound(const KinectParameters& parameters) {
  const auto is_positive = [](double value) { return std::isfinite(value) && value > 0; };
  return is_positive(parameters.baseline_cm) && is_positive(parameters.reference_distance_cm) &&
         is_positive(parameters.reference_pixel_cm) && is_positive(parameters.shift);
}

/// The accelerometer's axes are x to the left (seen from behind), y up and z forward. At rest its
/// reading points up. A model without firmware for it reads 0 g on all axes: it has no tilt.
std::optional<Tilt> to_tilt(const freenect_raw_tilt_state& state) {
  constexpr double counts_per_g = FREENECT_COUNTS_PER_G;
  const double left = state.accelerometer_x;
  const double up = state.accelerometer_y;
  const double forward = state.accelerometer_z;
  if (std::hypot(left, up, forward) < counts_per_g / 2) {
    return std::nullopt;
  }
  return Tilt{.pitch = std::atan2(forward, std::hypot(left, up)), .roll = std::atan2(left, up)};
}

}  // namespace

Kinect::Context Kinect::make_context(int subdevices) {
  freenect_context* context = nullptr;
  if (freenect_init(&context, nullptr) < 0) {
    throw Error(ErrorCode::sensor_missing, "kinect: this machine's USB cannot be used");
  }
  freenect_set_log_callback(context, discard_log);
  freenect_select_subdevices(context, static_cast<freenect_device_flags>(subdevices));
  return Context(context);
}

int Kinect::count() { return freenect_num_devices(make_context(FREENECT_DEVICE_CAMERA).get()); }

/// A model whose motor needs firmware is opened without it: depth works all the same.
Kinect::Kinect(int index) {
  has_accelerometer_ = open(index, FREENECT_DEVICE_CAMERA | FREENECT_DEVICE_MOTOR);
  if (!has_accelerometer_ && !open(index, FREENECT_DEVICE_CAMERA)) {
    throw Error(ErrorCode::sensor_missing, freenect_num_devices(context_.get()) > index
                                               ? "kinect: it is plugged in but cannot be opened"
                                               : "kinect: none is plugged in");
  }
  freenect_set_user(device_, this);
  // Nothing may be thrown through libfreenect, which is C.
  freenect_set_depth_callback(
      device_, [](freenect_device* device, void* readings, std::uint32_t /*time*/) noexcept {
        static_cast<Kinect*>(freenect_get_user(device))
            ->take_frame(static_cast<const std::uint16_t*>(readings));
      });
  freenect_set_depth_chunk_callback(device_, [](void* frame, void* data, int number, int bytes,
                                                void* kinect) noexcept {
    static_cast<Kinect*>(kinect)->take_packet(static_cast<std::byte*>(frame), data, number, bytes);
  });
  read_parameters();
  read_tilt();
  has_near_mode_ = freenect_set_flag(device_, FREENECT_NEAR_MODE, FREENECT_OFF) == 0;
}

Kinect::~Kinect() = default;

bool Kinect::open(int index, int subdevices) {
  context_ = make_context(subdevices);
  return freenect_open_device(context_.get(), &device_, index) == 0;
}

void Kinect::read_parameters() {
  freenect_registration registration = freenect_copy_registration(device_);
  const freenect_zero_plane_info& plane = registration.zero_plane_info;
  parameters_ = {.baseline_cm = static_cast<double>(plane.dcmos_emitter_dist),
                 .reference_distance_cm = static_cast<double>(plane.reference_distance),
                 .reference_pixel_cm = static_cast<double>(plane.reference_pixel_size),
                 .shift = registration.const_shift};
  freenect_destroy_registration(&registration);
  if (!is_sound(parameters_)) {
    throw Error(ErrorCode::sensor_failed, "kinect: its factory parameters make no sense");
  }
}

void Kinect::read_tilt() {
  if (!has_accelerometer_ || freenect_update_tilt_state(device_) < 0) {
    return;
  }
  const std::optional<Tilt> tilt = to_tilt(*freenect_get_tilt_state(device_));
  const std::lock_guard lock(tilt_mutex_);
  tilt_ = tilt;
}

std::optional<Tilt> Kinect::tilt() const {
  const std::lock_guard lock(tilt_mutex_);
  return tilt_;
}

bool Kinect::set_near_mode(bool on) {
  const std::unique_lock lock(usb_, std::try_to_lock);
  return lock.owns_lock() &&
         freenect_set_flag(device_, FREENECT_NEAR_MODE, on ? FREENECT_ON : FREENECT_OFF) == 0;
}

void Kinect::stream(const std::stop_token& stop,
                    const std::function<void(const RawFrame&)>& on_frame) {
  const std::lock_guard lock(usb_);
  on_frame_ = &on_frame;
  incoming_.packets_in_order = -1;
  if (freenect_start_depth(device_) < 0) {
    is_lost_ = true;
    return;
  }
  auto tilt_due = steady_clock::now() + tilt_interval;
  while (!stop.stop_requested()) {
    timeval longest = patience;
    if (is_loss(freenect_process_events_timeout(context_.get(), &longest))) {
      is_lost_ = true;
      break;
    }
    if (steady_clock::now() >= tilt_due) {
      read_tilt();
      tilt_due = steady_clock::now() + tilt_interval;
    }
  }
  freenect_stop_depth(device_);
}

/// Copies a packet to its place in the frame, as libfreenect does by default, and checks that none
/// was lost before it. libfreenect itself hands over incomplete frames, whose gaps show an earlier
/// frame. It reports losses only in its log, and misses two kinds: those in the first two frames,
/// and those that reach from the end of one frame into the next.
void Kinect::take_packet(std::byte* frame, const void* data, int number, int bytes) {
  std::memcpy(frame + static_cast<std::ptrdiff_t>(number) * packet_bytes, data,
              static_cast<std::size_t>(bytes));
  if (number == 0) {
    incoming_.packets_in_order = 0;
    incoming_.begin = steady_clock::now();
  }
  const bool follows = number == incoming_.packets_in_order && bytes == bytes_of_packet(number);
  incoming_.packets_in_order = follows ? number + 1 : -1;
}

/// A frame that lost its end is dropped here, too: libfreenect has then taken the first packet of
/// the next frame already, which makes the count wrong.
void Kinect::take_frame(const std::uint16_t* readings) {
  if (incoming_.packets_in_order == packets) {
    (*on_frame_)({.readings = std::span(readings, pixels), .time = incoming_.begin});
  } else {
    ++damaged_frames_;
  }
}

}  // namespace octurn
