#pragma once

#include <libcamera/libcamera.h>

#include "camera/camera.hpp"
#include "camera/grey_picture.hpp"

namespace octurn {

/// Sets a stream to the size, and to the format that is read with the least work: one with colours,
/// unless the camera has none.
/// @param name  of the camera, for messages
/// @return how pixels are arranged in that format
/// @throws Error "sensor-other"  that tells the sizes that the camera has, the largest first
PixelLayout choose_format(libcamera::CameraConfiguration& configuration, const CameraWish& wish,
                          const libcamera::Camera& camera, const std::string& name);

}  // namespace octurn
