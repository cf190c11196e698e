#include "camera/camera.hpp"

// What all cameras have in common: for the program, and for each module that is one.

namespace octurn {

std::optional<TimedPicture> Camera::read_in_colour(const std::stop_token& stop) {
  return read(stop);
}

void Camera::show_angle(double /*angle*/) {}

void Camera::set_object_pose(int /*pose*/) {}

void Camera::show_board(bool /*is_shown*/) {}

}  // namespace octurn
