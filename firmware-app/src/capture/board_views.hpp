#pragma once

#include <functional>
#include <stop_token>
#include <vector>

#include "calibration/board_watch.hpp"
#include "octurn/lens.hpp"
#include "sensor/depth_sensor.hpp"

namespace octurn {

/// Takes views of a printed board that somebody holds before a depth sensor: of each, an infrared
/// picture, then depth images, then a picture again, which shows whether the board was held still.
/// A Kinect can stream both at once, but its USB line is then nearly full: they take turns.
///
/// @param on_picture  called with each infrared picture, and what it shows
/// @return the views so far once they suffice, or if stopped
/// @throws Error "sensor-...", "sensor-other"  if the sensor shows no infrared pictures
std::vector<DepthBoardView> take_board_views(
    DepthSensor& sensor, const std::stop_token& stop,
    const std::function<void(const Picture& picture, const BoardLook& look)>& on_picture);

}  // namespace octurn
