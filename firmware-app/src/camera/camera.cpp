#include "camera/camera.hpp"

#include "module.hpp"

namespace octurn {

std::unique_ptr<Camera> open_camera(const CameraSettings& settings) {
  const auto& module = *static_cast<const CameraModule*>(load_module(
      "libOcturnCamera.so", "octurn_camera", "the driver of cameras",
      "Install libcamera, and Octurn as it is built with it; or start it with --simulate-laser."));
  return module.open(settings);
}

}  // namespace octurn
