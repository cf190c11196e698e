#pragma once

#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <utility>

#include "sensor/depth_sensor.hpp"

namespace octurn {

/// A sensor to derive from, which hands everything on to another one.
class WrappedSensor : public DepthSensor {
 public:
  explicit WrappedSensor(std::unique_ptr<DepthSensor> sensor) : sensor_(std::move(sensor)) {}

  const std::string& name() const override { return sensor_->name(); }
  const Intrinsics& intrinsics() const override { return sensor_->intrinsics(); }
  std::string serial() const override { return sensor_->serial(); }
  std::optional<TimedFrame> read(const std::stop_token& stop) override {
    return sensor_->read(stop);
  }
  bool has_infrared() const override { return sensor_->has_infrared(); }
  std::optional<Picture> read_infrared(const std::stop_token& stop) override {
    return sensor_->read_infrared(stop);
  }
  std::optional<Tilt> tilt() const override { return sensor_->tilt(); }
  std::optional<PacketCounts> packet_counts() const override { return sensor_->packet_counts(); }
  void show_angle(double angle) override { sensor_->show_angle(angle); }
  void show_wall(std::optional<double> distance) override { sensor_->show_wall(distance); }
  void show_board(int hold) override { sensor_->show_board(hold); }
  void set_object_pose(int pose) override { sensor_->set_object_pose(pose); }

 protected:
  std::unique_ptr<DepthSensor>& sensor() { return sensor_; }

 private:
  std::unique_ptr<DepthSensor> sensor_;
};

}  // namespace octurn
