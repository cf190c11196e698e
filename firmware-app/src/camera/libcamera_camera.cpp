// The module that drives cameras by libcamera: those of the Pi's CSI connectors, and USB cameras.
#include <libcamera/control_ids.h>
#include <libcamera/libcamera.h>
#include <libcamera/property_ids.h>
#include <linux/dma-buf.h>
#include <sys/ioctl.h>
#include <sys/mman.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <ctime>
#include <deque>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <stop_token>
#include <string>
#include <utility>
#include <vector>

#include "camera/camera.hpp"
#include "camera/colour_picture.hpp"
#include "camera/jpeg_picture.hpp"
#include "camera/pixel_formats.hpp"
#include "octurn/error.hpp"

namespace octurn {

namespace {

/// A plane of a buffer that a camera writes into, mapped for reading.
class MappedPlane {
 public:
  /// @throws Error "sensor-failed"
  explicit MappedPlane(const libcamera::FrameBuffer::Plane& plane);
  ~MappedPlane();
  MappedPlane(const MappedPlane&) = delete;
  MappedPlane& operator=(const MappedPlane&) = delete;

  std::span<const std::uint8_t> bytes() const {
    return {static_cast<const std::uint8_t*>(begin_) + offset_, length_};
  }

  /// Between these the processor sees what the camera wrote, also where its caches do not follow
  /// the camera.
  void begin_reading() const { sync(true); }
  void end_reading() const { sync(false); }

 private:
  void sync(bool begin) const;

  int fd_;
  std::size_t offset_;
  std::size_t length_;
  void* begin_;  // of the whole mapping, which begins with the file
};

/// All planes of a buffer.
class MappedBuffer {
 public:
  /// @throws Error "sensor-failed"
  explicit MappedBuffer(const libcamera::FrameBuffer& buffer);

  /// The planes' bytes, in their order.
  std::vector<std::span<const std::uint8_t>> planes() const;

  // As of a plane.
  void begin_reading() const;
  void end_reading() const;

 private:
  std::deque<MappedPlane> planes_ = {};  // which stay where they are
};

MappedPlane::MappedPlane(const libcamera::FrameBuffer::Plane& plane)
    : fd_(plane.fd.get()),
      offset_(plane.offset),
      length_(plane.length),
      begin_(::mmap(nullptr, offset_ + length_, PROT_READ, MAP_SHARED, fd_, 0)) {
  if (begin_ == MAP_FAILED) {
    throw Error(ErrorCode::sensor_failed,
                std::string("the camera's pictures cannot be read: ") + std::strerror(errno),
                "Unplug the camera, and plug it in again.");
  }
}

MappedPlane::~MappedPlane() { ::munmap(begin_, offset_ + length_); }

/// Buffers that are no DMA buffers refuse this, and need none.
void MappedPlane::sync(bool begin) const {
  dma_buf_sync how{.flags = DMA_BUF_SYNC_READ |
                            (begin ? std::uint64_t{DMA_BUF_SYNC_START} : DMA_BUF_SYNC_END)};
  static_cast<void>(::ioctl(fd_, DMA_BUF_IOCTL_SYNC, &how));
}

MappedBuffer::MappedBuffer(const libcamera::FrameBuffer& buffer) {
  for (const libcamera::FrameBuffer::Plane& plane : buffer.planes()) {
    planes_.emplace_back(plane);
  }
}

std::vector<std::span<const std::uint8_t>> MappedBuffer::planes() const {
  std::vector<std::span<const std::uint8_t>> bytes;
  for (const MappedPlane& plane : planes_) {
    bytes.push_back(plane.bytes());
  }
  return bytes;
}

void MappedBuffer::begin_reading() const {
  for (const MappedPlane& plane : planes_) {
    plane.begin_reading();
  }
}

void MappedBuffer::end_reading() const {
  for (const MappedPlane& plane : planes_) {
    plane.end_reading();
  }
}

/// Requests that libcamera's thread has completed, on their way to the thread that reads.
class CompletedRequests {
 public:
  enum class Outcome { completed, stopped, late, disconnected };

  /// Called by libcamera's thread.
  void add(libcamera::Request* request);
  void disconnect();

  /// Waits until there is a request; `late` if there is none at the deadline.
  Outcome wait(const std::stop_token& stop, std::chrono::steady_clock::time_point deadline);

  /// All that are there, the oldest first.
  std::vector<libcamera::Request*> take();

 private:
  std::mutex mutex_;
  std::condition_variable_any changed_;
  std::vector<libcamera::Request*> requests_ = {};
  bool is_disconnected_ = false;
};

void CompletedRequests::add(libcamera::Request* request) {
  {
    const std::lock_guard lock(mutex_);
    requests_.push_back(request);
  }
  changed_.notify_all();
}

void CompletedRequests::disconnect() {
  {
    const std::lock_guard lock(mutex_);
    is_disconnected_ = true;
  }
  changed_.notify_all();
}

CompletedRequests::Outcome CompletedRequests::wait(const std::stop_token& stop,
                                                   std::chrono::steady_clock::time_point deadline) {
  std::unique_lock lock(mutex_);
  const bool changed = changed_.wait_until(
      lock, stop, deadline, [this] { return is_disconnected_ || !requests_.empty(); });
  if (stop.stop_requested()) {
    return Outcome::stopped;
  }
  if (is_disconnected_) {
    return Outcome::disconnected;
  }
  return changed ? Outcome::completed : Outcome::late;
}

std::vector<libcamera::Request*> CompletedRequests::take() {
  const std::lock_guard lock(mutex_);
  return std::exchange(requests_, {});
}

using std::chrono::steady_clock;

constexpr auto longest_silence = std::chrono::seconds(2);
constexpr const char* again = "Unplug the camera, and plug it in again.";

/// Converts CLOCK_BOOTTIME to the steady clock (CLOCK_MONOTONIC), which stops during suspend.
steady_clock::time_point from_boot_time(std::int64_t nanoseconds) {
  timespec boot{};
  ::clock_gettime(CLOCK_BOOTTIME, &boot);
  const auto age = std::chrono::seconds(boot.tv_sec) + std::chrono::nanoseconds(boot.tv_nsec) -
                   std::chrono::nanoseconds(nanoseconds);
  return steady_clock::now() - std::chrono::duration_cast<steady_clock::duration>(age);
}

/// The camera's controls that it has, all fixed: light that changes from picture to picture would
/// be taken for a laser's.
libcamera::ControlList fixed_controls(const libcamera::Camera& camera,
                                      const CameraSettings& settings) {
  libcamera::ControlList controls(camera.controls());
  const auto set = [&](const auto& control, auto value) {
    if (camera.controls().find(control.id()) != camera.controls().end()) {
      controls.set(control, value);
    }
  };
  set(libcamera::controls::AeEnable, false);
  set(libcamera::controls::AwbEnable, false);
  set(libcamera::controls::ExposureTime, static_cast<std::int32_t>(settings.exposure.count()));
  set(libcamera::controls::AnalogueGain, static_cast<float>(settings.gain));
  set(libcamera::controls::AfMode, static_cast<std::int32_t>(libcamera::controls::AfModeManual));
  set(libcamera::controls::LensPosition, static_cast<float>(1 / settings.focus));  // dioptres
  return controls;
}

std::shared_ptr<libcamera::Camera> first_camera(libcamera::CameraManager& manager) {
  const auto cameras = manager.cameras();
  if (cameras.empty()) {
    throw Error(
        ErrorCode::sensor_missing, "no camera was found",
        "Plug in a USB camera, or connect one to the Pi's camera connector and start the Pi "
        "again. The command `cam -l` lists those that libcamera knows.");
  }
  return cameras.front();
}

std::string name_of(const libcamera::Camera& camera) {
  const auto model = camera.properties().get(libcamera::properties::Model);
  return model ? std::string(*model) : camera.id();
}

enum class Kind { grey, colour };

TimedPicture of_rows(std::span<const std::span<const std::uint8_t>> planes, const PixelRows& rows,
                     Kind kind) {
  TimedPicture picture{.picture = grey_picture(planes.front(), rows)};
  if (kind == Kind::colour) {
    picture.colours = colour_picture(planes, rows);
  }
  return picture;
}

/// @return nothing if the picture is damaged
std::optional<TimedPicture> of_jpeg(std::span<const std::uint8_t> bytes,
                                    const CameraSettings& settings, Kind kind) {
  if (kind == Kind::grey) {
    std::optional<Picture> picture = grey_jpeg(bytes, settings.width, settings.height);
    return picture ? std::optional(TimedPicture{.picture = std::move(*picture)}) : std::nullopt;
  }
  const auto jpeg = jpeg_planes(bytes, settings.width, settings.height);
  if (!jpeg) {
    return std::nullopt;
  }
  const std::vector<std::span<const std::uint8_t>> planes(jpeg->planes.begin(), jpeg->planes.end());
  return of_rows(planes, jpeg->rows, kind);
}

/// What the camera wrote into a buffer's first plane.
std::span<const std::uint8_t> written(std::span<const std::uint8_t> plane,
                                      const libcamera::FrameBuffer& buffer) {
  const std::size_t bytes = buffer.metadata().planes()[0].bytesused;
  return plane.first(std::min(bytes, plane.size()));
}

class LibcameraCamera final : public Camera {
 public:
  explicit LibcameraCamera(const CameraSettings& settings) : settings_(settings) {
    if (manager_.start() != 0) {
      throw Error(ErrorCode::sensor_failed, "libcamera does not start", again);
    }
    camera_ = first_camera(manager_);
    name_ = name_of(*camera_);
    expect(camera_->acquire() == 0, "is in use by another program",
           "End the other program, and try again.");
    try {
      start();
    } catch (...) {
      end();
      throw;
    }
  }

  ~LibcameraCamera() override { end(); }

  const std::string& name() const override { return name_; }
  std::string serial() const override { return camera_->id(); }

  std::optional<TimedPicture> read(const std::stop_token& stop) override {
    return read_newest(stop, Kind::grey);
  }
  std::optional<TimedPicture> read_in_colour(const std::stop_token& stop) override {
    return read_newest(stop, Kind::colour);
  }

 private:
  /// The newest picture that is there. A camera whose pictures are all damaged is as silent as one
  /// that sends none.
  std::optional<TimedPicture> read_newest(const std::stop_token& stop, Kind kind) {
    const auto deadline = steady_clock::now() + longest_silence;
    do {
      switch (completed_.wait(stop, deadline)) {
        case CompletedRequests::Outcome::stopped:
          return std::nullopt;
        case CompletedRequests::Outcome::disconnected:
          throw Error(ErrorCode::sensor_lost, "camera: " + name_ + " is gone", again);
        case CompletedRequests::Outcome::late:
        case CompletedRequests::Outcome::completed:
          break;
      }
      if (auto picture = newest(completed_.take(), kind)) {
        return picture;
      }
    } while (steady_clock::now() < deadline);
    throw Error(ErrorCode::sensor_silent,
                "camera: " + name_ + " has sent no whole picture for 2 seconds", again);
  }

  void expect(bool holds, const std::string& otherwise, const char* hint = again) const {
    if (!holds) {
      throw Error(ErrorCode::sensor_failed, "camera: " + name_ + " " + otherwise, hint);
    }
  }

  void start() {
    const std::unique_ptr<libcamera::CameraConfiguration> configuration =
        camera_->generateConfiguration({libcamera::StreamRole::VideoRecording});
    expect(configuration != nullptr && !configuration->empty(), "has no stream of pictures");
    const auto layout = choose_format(*configuration, settings_, *camera_, name_);
    expect(camera_->configure(configuration.get()) == 0, "cannot be set up");
    libcamera::Stream* const stream = configuration->at(0).stream();
    if (layout) {
      rows_ = {.layout = *layout,
               .width = settings_.width,
               .height = settings_.height,
               .stride = configuration->at(0).stride};
    }
    buffers_ = std::make_unique<libcamera::FrameBufferAllocator>(camera_);
    expect(buffers_->allocate(stream) > 0, "has no memory for its pictures");
    for (const auto& buffer : buffers_->buffers(stream)) {
      mapped_.emplace_back(*buffer);
      std::unique_ptr<libcamera::Request> request = camera_->createRequest(mapped_.size() - 1);
      expect(request != nullptr && request->addBuffer(stream, buffer.get()) == 0,
             "takes no requests");
      requests_.push_back(std::move(request));
    }
    camera_->requestCompleted.connect(this, &LibcameraCamera::on_completed);
    camera_->disconnected.connect(this, &LibcameraCamera::on_disconnected);
    libcamera::ControlList controls = fixed_controls(*camera_, settings_);
    expect(camera_->start(&controls) == 0, "does not start");
    for (const auto& request : requests_) {
      request->controls().merge(controls);  // USB cameras take none at their start
      expect(camera_->queueRequest(request.get()) == 0, "takes no requests");
    }
  }

  void end() {
    camera_->stop();
    camera_->requestCompleted.disconnect(this);
    camera_->disconnected.disconnect(this);
    requests_.clear();
    mapped_.clear();
    buffers_.reset();
    camera_->release();
    camera_.reset();
    manager_.stop();
  }

  void on_completed(libcamera::Request* request) {
    if (request->status() == libcamera::Request::RequestComplete) {
      completed_.add(request);
    }
  }

  void on_disconnected() { completed_.disconnect(); }

  /// The picture of the last request that has one; all are queued again.
  std::optional<TimedPicture> newest(const std::vector<libcamera::Request*>& requests, Kind kind) {
    std::optional<TimedPicture> picture;
    for (auto request = requests.rbegin(); request != requests.rend(); ++request) {
      if (!picture) {
        picture = picture_of(**request, kind);
      }
      (*request)->reuse(libcamera::Request::ReuseBuffers);
      if (camera_->queueRequest(*request) != 0) {
        throw Error(ErrorCode::sensor_lost, "camera: " + name_ + " is gone", again);
      }
    }
    return picture;
  }

  /// @return nothing if the picture is damaged, as the driver says or as is seen
  std::optional<TimedPicture> picture_of(libcamera::Request& request, Kind kind) const {
    const libcamera::FrameBuffer& buffer = *request.buffers().begin()->second;
    if (buffer.metadata().status != libcamera::FrameMetadata::FrameSuccess) {
      return std::nullopt;
    }
    const MappedBuffer& mapped = mapped_[request.cookie()];
    mapped.begin_reading();
    std::optional<TimedPicture> picture =
        rows_ ? of_rows(mapped.planes(), *rows_, kind)
              : of_jpeg(written(mapped.planes().front(), buffer), settings_, kind);
    mapped.end_reading();
    if (picture) {
      picture->begin = begin_of(request);
    }
    return picture;
  }

  /// Drivers tell when a row's exposure begins or when it ends: the earlier is counted, so that no
  /// picture is taken for one of a laser that was switched on in its middle.
  steady_clock::time_point begin_of(libcamera::Request& request) const {
    const auto stamp = request.metadata().get(libcamera::controls::SensorTimestamp);
    const auto exposed = request.metadata().get(libcamera::controls::ExposureTime);
    const std::chrono::microseconds exposure =
        exposed ? std::chrono::microseconds(*exposed) : settings_.exposure;
    const std::int64_t at =
        stamp ? *stamp
              : static_cast<std::int64_t>(request.buffers().begin()->second->metadata().timestamp);
    return from_boot_time(at) - exposure;
  }

  CameraSettings settings_;
  libcamera::CameraManager manager_ = {};
  std::shared_ptr<libcamera::Camera> camera_ = {};
  std::string name_ = {};
  std::optional<PixelRows> rows_ = {};  // nothing: each picture is a JPEG
  std::unique_ptr<libcamera::FrameBufferAllocator> buffers_ = {};
  std::deque<MappedBuffer> mapped_ = {};                            // in the buffers' order
  std::vector<std::unique_ptr<libcamera::Request>> requests_ = {};  // cookie: index of its buffer
  CompletedRequests completed_ = {};
};

std::unique_ptr<Camera> open(const CameraSettings& settings) {
  return std::make_unique<LibcameraCamera>(settings);
}

}  // namespace

}  // namespace octurn

extern "C" __attribute__((visibility("default"))) const octurn::CameraModule octurn_camera;
extern "C" const octurn::CameraModule octurn_camera{.open = octurn::open};
