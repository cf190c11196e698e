// A replacement of libusb-1.0, as far as Octurn's and OpenNI2's drivers use it. Its bus has one
// emulated Kinect or nothing. A program that loads it first (LD_LIBRARY_PATH) sees that bus instead
// of the machine's; all layers above are the real ones.
//
// This file has the devices and their control transfers.

#include <libusb.h>

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <span>
#include <thread>

#include "kinect/emulated/libusb_context.hpp"

using octurn::EmulatedKinect;
using octurn::KinectModel;
using octurn::KinectPart;

namespace {

constexpr int stalled = LIBUSB_ERROR_PIPE;  // the answer to an unsupported request

/// Whether a device answers no control transfer.
bool hangs(const libusb_device_handle& handle) {
  const EmulatedKinect& kinect = handle.device->context->bus->kinect;
  const KinectPart part = handle.device->part;
  return (part == KinectPart::camera && kinect.camera_hangs) ||
         (part == KinectPart::motor && kinect.motor_hangs);
}

/// Whether a part is on the bus now, as its listing shows it.
bool is_there(KinectPart part, EmulatedKinect& kinect) {
  if (part == KinectPart::audio && kinect.audio_absences > 0) {
    --kinect.audio_absences;
    return false;
  }
  return part != KinectPart::motor || kinect.model == KinectModel::k1414;
}

/// Waits for a device that hangs. @param timeout  milliseconds; 0: for ever, as libusb does
int wait_in_vain(const libusb_device_handle& handle, unsigned timeout) {
  using std::chrono::steady_clock;
  const auto deadline = steady_clock::now() + std::chrono::milliseconds(timeout);
  while (hangs(handle) && (timeout == 0 || steady_clock::now() < deadline)) {
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return LIBUSB_ERROR_TIMEOUT;
}

}  // namespace

extern "C" {

int libusb_init(libusb_context** context) {
  auto made = std::make_unique<libusb_context>();
  for (std::size_t part = 0; part < made->devices.size(); ++part) {
    made->devices[part] = {made.get(), static_cast<KinectPart>(part)};
  }
  if (const char* folder = std::getenv(octurn::emulated_kinect_variable)) {
    made->bus.emplace(folder);
  }
  *context = made.release();
  return 0;
}

void libusb_exit(libusb_context* context) { const std::unique_ptr<libusb_context> owned(context); }

const char* libusb_error_name(int /*code*/) { return "error of the emulated bus"; }

ssize_t libusb_get_device_list(libusb_context* context, libusb_device*** list) {
  auto* devices = static_cast<libusb_device**>(std::calloc(4, sizeof(libusb_device*)));
  ssize_t count = 0;
  if (context->bus && context->bus->kinect.plugged) {
    for (libusb_device& device : context->devices) {
      if (is_there(device.part, context->bus->kinect)) {
        devices[count++] = &device;
      }
    }
  }
  *list = devices;
  return count;
}

void libusb_free_device_list(libusb_device** list, int /*unref*/) {
  std::free(static_cast<void*>(list));
}

libusb_device* libusb_ref_device(libusb_device* device) { return device; }
void libusb_unref_device(libusb_device* /*device*/) {}

int libusb_get_device_descriptor(libusb_device* device, libusb_device_descriptor* descriptor) {
  const KinectModel model = device->context->bus->kinect.model;
  *descriptor = {};
  descriptor->bLength = LIBUSB_DT_DEVICE_SIZE;
  descriptor->bDescriptorType = LIBUSB_DT_DEVICE;
  descriptor->idVendor = octurn::microsoft;
  descriptor->idProduct = octurn::usb_product(device->part, model);
  descriptor->bcdDevice = octurn::usb_release(model);
  descriptor->iSerialNumber = 3;
  descriptor->bNumConfigurations = 1;
  return 0;
}

/// Returns a configuration with one interface, as an audio device without firmware has.
int libusb_get_active_config_descriptor(libusb_device* /*device*/,
                                        libusb_config_descriptor** configuration) {
  auto made = std::make_unique<libusb_config_descriptor>();
  made->bNumInterfaces = 1;
  *configuration = made.release();
  return 0;
}

void libusb_free_config_descriptor(libusb_config_descriptor* configuration) {
  const std::unique_ptr<libusb_config_descriptor> owned(configuration);
}

int libusb_get_max_iso_packet_size(libusb_device* /*device*/, unsigned char /*endpoint*/) {
  return octurn::max_iso_packet_bytes;
}

std::uint8_t libusb_get_bus_number(libusb_device* /*device*/) { return 1; }
std::uint8_t libusb_get_device_address(libusb_device* device) {
  return static_cast<std::uint8_t>(1 + static_cast<int>(device->part));
}
libusb_device* libusb_get_parent(libusb_device* /*device*/) { return nullptr; }

int libusb_open(libusb_device* device, libusb_device_handle** handle) {
  const EmulatedKinect& kinect = device->context->bus->kinect;
  if (!kinect.plugged) {
    return LIBUSB_ERROR_NO_DEVICE;
  }
  auto made = std::make_unique<libusb_device_handle>();
  *made = {device, kinect.plugged_times};
  *handle = made.release();
  return 0;
}

void libusb_close(libusb_device_handle* handle) {
  const std::unique_ptr<libusb_device_handle> owned(handle);
}

libusb_device* libusb_get_device(libusb_device_handle* handle) { return handle->device; }

int libusb_get_string_descriptor_ascii(libusb_device_handle* handle, std::uint8_t /*index*/,
                                       unsigned char* data, int length) {
  const EmulatedKinect& kinect = handle->device->context->bus->kinect;
  const auto count = octurn::usb_serial_number(handle->device->part, kinect.model)
                         .copy(reinterpret_cast<char*>(data), static_cast<std::size_t>(length) - 1);
  data[count] = 0;
  return static_cast<int>(count);
}

int libusb_claim_interface(libusb_device_handle* /*handle*/, int /*number*/) { return 0; }
int libusb_release_interface(libusb_device_handle* /*handle*/, int /*number*/) { return 0; }
int libusb_kernel_driver_active(libusb_device_handle* /*handle*/, int /*number*/) { return 0; }
int libusb_detach_kernel_driver(libusb_device_handle* /*handle*/, int /*number*/) { return 0; }
int libusb_attach_kernel_driver(libusb_device_handle* /*handle*/, int /*number*/) { return 0; }
int libusb_set_interface_alt_setting(libusb_device_handle* /*handle*/, int /*number*/,
                                     int /*setting*/) {
  return 0;
}
int libusb_reset_device(libusb_device_handle* handle) {
  EmulatedKinect& kinect = handle->device->context->bus->kinect;
  if (handle->device->part == KinectPart::audio) {
    ++kinect.audio_resets;
    kinect.audio_absences = 20;
  }
  return 0;
}

int libusb_control_transfer(libusb_device_handle* handle, std::uint8_t type, std::uint8_t request,
                            std::uint16_t value, std::uint16_t index, unsigned char* data,
                            std::uint16_t length, unsigned timeout) {
  if (is_dead(*handle)) {
    return LIBUSB_ERROR_NO_DEVICE;
  }
  auto& bus = *handle->device->context->bus;
  if (hangs(*handle)) {
    return wait_in_vain(*handle, timeout);
  }
  const auto transferred = octurn::vendor_request(
      handle->device->part,
      {.type = type, .request = request, .value = value, .index = index, .length = length},
      bus.kinect, bus.camera, std::span(data, length));
  return transferred ? static_cast<int>(*transferred) : stalled;
}

int libusb_bulk_transfer(libusb_device_handle* /*handle*/, unsigned char /*endpoint*/,
                         unsigned char* /*data*/, int /*length*/, int* transferred,
                         unsigned /*timeout*/) {
  *transferred = 0;
  return stalled;
}

int libusb_interrupt_transfer(libusb_device_handle* handle, unsigned char endpoint,
                              unsigned char* data, int length, int* transferred, unsigned timeout) {
  return libusb_bulk_transfer(handle, endpoint, data, length, transferred, timeout);
}

}  // extern "C"
