#pragma once

#include <memory>

#include "camera/camera.hpp"

// The interface between the program and its driver of cameras, which is a module: only a program
// that looks with a camera loads it, and libcamera with it.

namespace octurn {

/// What the module libOcturnCamera offers, as its symbol `octurn_camera`.
struct CameraModule {
  /// @throws Error  as `open_camera`
  std::unique_ptr<Camera> (*open)(const CameraSettings& settings) = nullptr;
};

}  // namespace octurn
