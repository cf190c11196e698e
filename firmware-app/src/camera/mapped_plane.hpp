#pragma once

#include <libcamera/libcamera.h>

#include <cstddef>
#include <cstdint>
#include <deque>
#include <span>
#include <vector>

namespace octurn {

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

}  // namespace octurn
