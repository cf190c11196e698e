#include "camera/camera.hpp"

#include "octurn/error.hpp"

namespace octurn {

void Camera::show_angle(double /*angle*/) {}

void Camera::lay_object(int /*pose*/) {}

std::unique_ptr<Camera> open_camera() {
  throw Error(ErrorCode::sensor_missing,
              "no camera: this version drives none, only the simulated one",
              "Start Octurn with --simulate-laser, or set \"sensor\" to \"depth\" in octurn.json.");
}

}  // namespace octurn
