#pragma once

#include <libcamera/libcamera.h>

#include <optional>
#include <string>

#include "camera/camera.hpp"
#include "camera/grey_picture.hpp"

namespace octurn {

/// Sets a stream to the size, and to the format that is read with the least work: one with colours,
/// unless the camera has none. A compressed one is taken where the camera has no other of the size,
/// or makes too few pictures in it, as many USB cameras do of large ones.
/// @param name  of the camera, for messages
/// @return how pixels are arranged in that format; nothing if each picture is a JPEG
/// @throws Error "sensor-other"  that tells the sizes that the camera has, the largest first
std::optional<PixelLayout> choose_format(libcamera::CameraConfiguration& configuration,
                                         const CameraSettings& settings,
                                         const libcamera::Camera& camera, const std::string& name);

}  // namespace octurn
