#pragma once

#include <libusb.h>

#include <array>
#include <chrono>
#include <cstdint>
#include <deque>
#include <filesystem>
#include <optional>

#include "kinect/emulated/camera.hpp"
#include "kinect/emulated/mapped_file.hpp"
#include "kinect/emulated/usb_parts.hpp"

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
  /// The Kinect of the folder in the environment variable.
  struct Bus {
    explicit Bus(const std::filesystem::path& folder)
        : control(folder / "kinect"), frames(folder / "frames") {}
    octurn::MappedFile control;
    octurn::MappedFile frames;
    octurn::EmulatedKinect& kinect = control.as<octurn::EmulatedKinect>();
    octurn::EmulatedCamera camera = octurn::EmulatedCamera(
        kinect, octurn::over_and_over(frames.values<octurn::EmulatedCamera::Reading>()));
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
