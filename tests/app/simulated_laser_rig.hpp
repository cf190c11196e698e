#pragma once

#include <array>
#include <atomic>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "calibration/lens_files.hpp"
#include "camera/simulated_camera.hpp"
#include "capture/rig.hpp"
#include "octurn/error.hpp"
#include "rig/nominal_laser_rig.hpp"

namespace octurn {

/// The settings of a rig with a small camera.
inline LaserSettings small_laser_settings() {
  LaserSettings settings;
  settings.lens = {.width = 410, .height = 308, .fx = 341.2, .fy = 341.2, .cx = 204.5, .cy = 153.5};
  return settings;
}

/// A simulated rig with a camera and lasers that fails as a test wants. It tracks which lasers are
/// on. A Scanner also reads pictures while it has no scan, so what a test may use then is atomic or
/// a function.
class SimulatedLaserRig {
 public:
  using OnPicture = std::function<void(SimulatedLaserRig& rig)>;

  explicit SimulatedLaserRig(LaserSettings settings = small_laser_settings())
      : settings_(std::move(settings)) {}

  RigOptions options(double speed) {
    return {.speed = speed, .laser = settings_, .open_camera = [this, speed](const auto&) {
              if (is_unplugged) {
                throw Error(ErrorCode::sensor_missing, "no camera is plugged in", "Plug it in.");
              }
              std::vector<Laser> lasers = laser_camera(settings_).lasers;
              const Eigen::Isometry3d pose = other_pose.value_or(settings_.platform_from_sensor);
              const Eigen::Vector3d up = pose.linear().transpose() * Eigen::Vector3d::UnitZ();
              lasers.front() = turned_in_holder(lasers.front(), up, left_turn);
              const CameraLens lens = other_lens.value_or(told_lens(settings_));
              CameraAndLasers opened = simulate_laser_rig({.lens = lens.intrinsics,
                                                           .k1 = lens.k1,
                                                           .k2 = lens.k2,
                                                           .platform_from_sensor = pose,
                                                           .lasers = lasers},
                                                          speed, late);
              opened.camera = std::make_unique<FailingCamera>(*this, std::move(opened.camera));
              opened.set_line = [this, set = std::move(opened.set_line)](std::size_t laser,
                                                                         bool on) {
                set(laser, on && !(dark_laser == laser));
                add_to_log(static_cast<char>((on ? 'A' : 'a') + static_cast<char>(laser)));
                is_on_[laser] = on;
              };
              return opened;
            }};
  }

  bool is_lit() const { return is_on_[0] || is_on_[1]; }

  /// A and B for a laser that was switched on, a and b for off, p for a picture.
  std::string log() const {
    const std::lock_guard lock(mutex_);
    return log_;
  }

  /// Has a function called before each picture, on the thread that reads it.
  void on_picture(OnPicture action) {
    const std::lock_guard lock(mutex_);
    on_picture_ = std::make_shared<OnPicture>(std::move(action));
  }

  std::atomic<bool> is_unplugged = false;
  std::atomic<int> lost_pictures = 0;                ///< so many of the next are never handed out
  std::atomic<int> pictures = 0;                     ///< that were handed out
  std::optional<std::size_t> dark_laser = {};        ///< that gives no light; set before a scan
  std::optional<CameraLens> other_lens = {};         ///< that differs from the told one
  std::optional<Eigen::Isometry3d> other_pose = {};  ///< the same of the camera's pose
  int late = 0;                                      ///< pictures by which the camera is late
  double left_turn = 0;  ///< radians that the left laser was turned in its holder, untold

 private:
  class FailingCamera final : public Camera {
   public:
    FailingCamera(SimulatedLaserRig& rig, std::unique_ptr<Camera> camera)
        : rig_(rig), camera_(std::move(camera)) {}
    const std::string& name() const override { return camera_->name(); }
    std::string serial() const override { return camera_->serial(); }
    void show_angle(double angle) override { camera_->show_angle(angle); }
    void show_board(bool is_shown) override { camera_->show_board(is_shown); }
    std::optional<TimedPicture> read(const std::stop_token& stop) override {
      return read_by([&] { return camera_->read(stop); });
    }
    std::optional<TimedPicture> read_in_colour(const std::stop_token& stop) override {
      return read_by([&] { return camera_->read_in_colour(stop); });
    }

   private:
    template <typename Read>
    std::optional<TimedPicture> read_by(const Read& read) {
      rig_.tell_of_picture();
      if (rig_.is_unplugged) {
        throw Error(ErrorCode::sensor_lost, "the camera is gone", "Plug it in.");
      }
      if (rig_.lost_pictures > 0) {
        --rig_.lost_pictures;
        throw Error(ErrorCode::sensor_silent, "no picture for 2000 ms", "Plug it in again.");
      }
      auto picture = read();
      rig_.pictures += picture ? 1 : 0;
      if (picture) {
        rig_.add_to_log('p');
      }
      return picture;
    }

    SimulatedLaserRig& rig_;
    std::unique_ptr<Camera> camera_;
  };

  void add_to_log(char what) {
    const std::lock_guard lock(mutex_);
    log_ += what;
  }

  void tell_of_picture() {
    std::unique_lock lock(mutex_);
    const auto action = on_picture_;
    lock.unlock();
    if (action) {
      (*action)(*this);
    }
  }

  LaserSettings settings_;
  std::array<std::atomic<bool>, 2> is_on_ = {};
  mutable std::mutex mutex_ = {};  // guards what follows
  std::string log_ = {};
  std::shared_ptr<OnPicture> on_picture_ = {};
};

}  // namespace octurn
