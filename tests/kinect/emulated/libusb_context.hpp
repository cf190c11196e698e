#pragma once

#include <libusb.h>

#include <array>
#include <chrono>
#include <cstdint>
#include <deque>
#include <filesystem>
#include <memory>
#include <optional>
#include <vector>

#include "kinect/emulated/camera.hpp"
#include "kinect/emulated/mapped_file.hpp"
#include "kinect/emulated/usb_parts.hpp"
#include "octurn/file.hpp"
#include "rig/usb_log.hpp"

// The types that libusb's headers leave incomplete: devices, and a program's view of the bus.

struct libusb_device {
  libusb_context* context = nullptr;
  octurn::KinectPart part = octurn::KinectPart::camera;
};

struct libusb_device_handle {
  libusb_device* device = nullptr;
  int plugged_times = 0;  // the device's count when the handle was opened
};

/// A program's view of the bus. The driver uses each from one thread at a time.
struct libusb_context {
  /// The Kinect of the folder in the environment variable. A file `usb` in it is a recording of
  /// `octurn record --usb`, whose losses it repeats.
  struct Bus {
    explicit Bus(const std::filesystem::path& folder)
        : control(folder / "kinect"),
          frames(folder / "frames"),
          infrared(std::filesystem::exists(folder / "infrared")
                       ? std::make_unique<octurn::MappedFile>(folder / "infrared")
                       : nullptr),
          losses(octurn::lost_packets(octurn::parse_usb_log(
              octurn::read_regular_file(folder / "usb", octurn::max_usb_log_bytes)
                  .value_or("octurn-usb 1\nend\n")))) {}
    octurn::MappedFile control;
    octurn::MappedFile frames;
    std::unique_ptr<octurn::MappedFile> infrared;
    std::vector<bool> losses;
    octurn::EmulatedKinect& kinect = control.as<octurn::EmulatedKinect>();
    octurn::EmulatedCamera camera = octurn::EmulatedCamera(
        kinect, octurn::over_and_over(frames.values<octurn::EmulatedCamera::Reading>()), losses,
        infrared ? octurn::over_and_over(infrared->values<octurn::EmulatedCamera::Reading>(),
                                         octurn::EmulatedCamera::infrared_pixels)
                 : nullptr);
  };

  std::optional<Bus> bus = {};
  std::array<libusb_device, 3> devices = {};
  std::deque<libusb_transfer*> waiting = {};
  std::deque<libusb_transfer*> cancelled = {};
  std::chrono::steady_clock::time_point begin = {};  // start of the current run of transfers
  std::int64_t microframes = 0;                      // completed since `begin`
};

/// Whether the device was unplugged since it was opened.
inline bool is_dead(const libusb_device_handle& handle) {
  const auto& bus = handle.device->context->bus;
  return !bus->kinect.plugged || bus->kinect.plugged_times != handle.plugged_times;
}
