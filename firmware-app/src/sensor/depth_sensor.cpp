#include "sensor/depth_sensor.hpp"

#include <filesystem>
#include <utility>

#include "sensor/sensor_device.hpp"

namespace octurn {

DepthSensor::DepthSensor(const std::string& uri)
    : device_(std::filesystem::is_directory(uri) ? open_recording(uri) : open_openni_device(uri)) {}

DepthSensor::DepthSensor(std::unique_ptr<SensorDevice> device) : device_(std::move(device)) {}

DepthSensor::~DepthSensor() = default;

const std::string& DepthSensor::name() const { return device_->name(); }

const Intrinsics& DepthSensor::intrinsics() const { return device_->intrinsics(); }

std::optional<TimedFrame> DepthSensor::read(const std::stop_token& stop) {
  return device_->read(stop);
}

std::optional<Tilt> DepthSensor::tilt() const { return device_->tilt(); }

std::optional<int> DepthSensor::damaged_frames() const { return device_->damaged_frames(); }

void DepthSensor::show_angle(double angle) { device_->show_angle(angle); }

}  // namespace octurn
