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
/// frames.
class KinectOnDesk {
 public:
  explicit KinectOnDesk(const std::vector<Readings>& frames) {
    std::string seen;
    for (const Readings& frame : frames) {
      seen.append(reinterpret_cast<const char*>(frame.data()), frame.size() * sizeof frame[0]);
    }
    put(folder_.path() / "frames", seen);
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
  TemporaryFolder folder_;
  std::unique_ptr<MappedFile> control_;
};

}  // namespace octurn
