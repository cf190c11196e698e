#include "camera/frame_rate.hpp"

#include <fcntl.h>
#include <linux/videodev2.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <system_error>

namespace octurn {
namespace {

/// Intervals from picture to picture, the shortest of which is the first of a range.
double fastest_rate_hz(int device, std::uint32_t format, unsigned width, unsigned height) {
  double fastest = 0;
  v4l2_frmivalenum interval{};
  interval.pixel_format = format;
  interval.width = width;
  interval.height = height;
  while (::ioctl(device, VIDIOC_ENUM_FRAMEINTERVALS, &interval) == 0) {
    const bool is_discrete = interval.type == V4L2_FRMIVAL_TYPE_DISCRETE;
    const v4l2_fract& seconds = is_discrete ? interval.discrete : interval.stepwise.min;
    if (seconds.numerator > 0) {
      fastest = std::max(fastest, double{1} * seconds.denominator / seconds.numerator);
    }
    if (!is_discrete) {
      break;
    }
    ++interval.index;
  }
  return fastest;
}

}  // namespace

std::vector<std::filesystem::path> video_devices(const std::string& camera_id,
                                                 const std::filesystem::path& sys) {
  std::vector<std::filesystem::path> devices;
  std::error_code none;
  for (const auto& entry :
       std::filesystem::directory_iterator(sys / "class" / "video4linux", none)) {
    // The interface of a USB device, "BUS-PORT:CONFIGURATION.INTERFACE".
    const std::string interface =
        std::filesystem::canonical(entry.path() / "device", none).filename();
    const std::size_t port = interface.find('-');
    if (port != std::string::npos &&
        camera_id.find(interface.substr(port) + "-") != std::string::npos) {
      devices.push_back("/dev" / entry.path().filename());
    }
  }
  return devices;
}

double fastest_rate_hz(const std::vector<std::filesystem::path>& devices, std::uint32_t format,
                       unsigned width, unsigned height) {
  double fastest = 0;
  for (const std::filesystem::path& path : devices) {
    const int device = ::open(path.c_str(), O_RDWR | O_NONBLOCK | O_CLOEXEC);
    if (device >= 0) {
      fastest = std::max(fastest, fastest_rate_hz(device, format, width, height));
      ::close(device);
    }
  }
  return fastest;
}

}  // namespace octurn
