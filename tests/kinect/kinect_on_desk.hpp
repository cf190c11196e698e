#pragma once

#include <cstdint>
#include <cstdlib>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "kinect/emulated/emulated_kinect.hpp"
#include "kinect/emulated/mapped_file.hpp"
#include "support/temporary_folder.hpp"

namespace octurn {

/// Raw readings of one frame, row by row.
using Readings = std::vector<std::uint16_t>;

/// An emulated Kinect for this test and the programs that it starts. It repeats a sequence of
/// frames, and one of infrared pictures, each of 640 x 488 readings.
class KinectOnDesk {
 public:
  explicit KinectOnDesk(const std::vector<Readings>& frames,
                        const std::vector<Readings>& infrared = {}) {
    put(folder_.path() / "frames", bytes_of(frames));
    if (!infrared.empty()) {
      put(folder_.path() / "infrared", bytes_of(infrared));
    }
    put(folder_.path() / "kinect", std::string(sizeof(EmulatedKinect), '\0'));
    control_ = std::make_unique<MappedFile>(folder_.path() / "kinect");
    std::construct_at(&kinect());
    ::setenv(emulated_kinect_variable, folder_.path().c_str(), 1);
  }
  ~KinectOnDesk() { ::unsetenv(emulated_kinect_variable); }
  KinectOnDesk(const KinectOnDesk&) = delete;
  KinectOnDesk& operator=(const KinectOnDesk&) = delete;

  EmulatedKinect& kinect() { return control_->as<EmulatedKinect>(); }
  EmulatedKinect* operator->() { return &kinect(); }

  /// Repeats the losses of a recording from when it is opened next. @param text  of the file
  void repeat_losses(const std::string& text) { put(folder_.path() / "usb", text); }

  void unplug() { kinect().plugged = false; }
  void plug_in() {
    ++kinect().plugged_times;
    kinect().plugged = true;
  }

 private:
  static std::string bytes_of(const std::vector<Readings>& frames) {
    std::string bytes;
    for (const Readings& frame : frames) {
      bytes.append(reinterpret_cast<const char*>(frame.data()), frame.size() * sizeof frame[0]);
    }
    return bytes;
  }

  TemporaryFolder folder_;
  std::unique_ptr<MappedFile> control_;
};

}  // namespace octurn
