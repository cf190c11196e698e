#include "camera/mapped_plane.hpp"

#include <linux/dma-buf.h>
#include <sys/ioctl.h>
#include <sys/mman.h>

#include <cerrno>
#include <cstring>
#include <string>

#include "octurn/error.hpp"

namespace octurn {

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

}  // namespace octurn
