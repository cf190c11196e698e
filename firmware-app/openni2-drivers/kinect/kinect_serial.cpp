#include "kinect/kinect_serial.hpp"

#include <libfreenect.h>

#include <memory>

#include "kinect/freenect_log.hpp"

namespace octurn {
namespace {

struct End {
  void operator()(freenect_context* context) const { freenect_shutdown(context); }
};

/// The serial number from libfreenect; empty if it has only zeros, as on some models.
std::string told_serial(int index) {
  freenect_context* opened = nullptr;
  if (freenect_init(&opened, nullptr) < 0) {
    return {};
  }
  const std::unique_ptr<freenect_context, End> context(opened);
  freenect_set_log_callback(context.get(), discard_log);
  freenect_device_attributes* first = nullptr;
  if (freenect_list_device_attributes(context.get(), &first) <= index) {
    freenect_free_device_attributes(first);
    return {};
  }
  const std::unique_ptr<freenect_device_attributes, decltype(&freenect_free_device_attributes)>
      owned(first, &freenect_free_device_attributes);
  const freenect_device_attributes* kinect = first;
  for (int i = 0; i < index; ++i) {
    kinect = kinect->next;
  }
  std::string serial = kinect->camera_serial == nullptr ? "" : kinect->camera_serial;
  return serial.find_first_not_of('0') == serial.npos ? std::string() : serial;
}

}  // namespace

std::string kinect_serial(int index) {
  std::string serial = told_serial(index);
  return serial.empty() ? usb_place(index) : serial;
}

}  // namespace octurn
