#include "sensor/depth_sensor.hpp"

#include "octurn/error.hpp"
#include "rig/simulation.hpp"

namespace octurn {

std::optional<Picture> DepthSensor::read_infrared(const std::stop_token& /*stop*/) {
  throw Error(ErrorCode::sensor_other, name() + ": shows no infrared pictures",
              "A printed board is for a Kinect v1, or for a camera with lasers.",
              {{"no_infrared", name()}});
}

void DepthSensor::show_board(int /*hold*/) {}

void DepthSensor::show_wall(std::optional<double> /*distance*/) {}

void DepthSensor::set_object_pose(int /*pose*/) {}

bool is_simulated_sensor(const std::string& uri) { return uri.starts_with(simulator_scheme); }

}  // namespace octurn
