#include "capture/capture.hpp"

#include <utility>

#include "calibration/lens_files.hpp"
#include "calibration/optics_files.hpp"
#include "calibration/sensor_map_files.hpp"
#include "capture/scan_of_rig.hpp"
#include "octurn/scan_folder.hpp"
#include "octurn/sensor_map.hpp"

namespace octurn {
namespace {

namespace fs = std::filesystem;

class DepthCapture final : public Capture {
 public:
  DepthCapture(Rig& rig, fs::path data) : rig_(rig), data_(std::move(data)) {}

  std::string serial() override { return rig_.sensor().serial(); }

  bool has_infrared() override { return rig_.sensor().has_infrared(); }

  std::optional<Seen> read(const std::stop_token& stop) override {
    std::optional<TimedFrame> timed = rig_.sensor().read(stop);
    return timed ? std::optional<Seen>(std::move(timed->frame)) : std::nullopt;
  }

  void use_stored(const ScanSettings& settings, const fs::path& begun) override {
    if (!begun.empty()) {
      rig_.use_optics(read_scan(begun).optics);  // known or not
      return;
    }
    const auto kept = optics_record(data_, serial());
    rig_.use_optics(kept ? std::optional(scaled(kept->optics, settings.depth_scale))
                         : std::nullopt);
  }

  void keep_sensor_map(const fs::path& folder) override {
    octurn::keep_sensor_map(data_, serial(), folder);
  }

  std::optional<TurnReport> measure_turn(const ScanSettings& settings, int threads,
                                         const std::stop_token& stop,
                                         const ScanObserver& observer) override {
    return octurn::measure_turn(settings, find_sensor_map(), threads, rig_, stop, observer);
  }

  PoseRecord to_record(const CalibrationReport& report, PoseOrigin origin,
                       const ScanSettings& settings,
                       const std::vector<Laser>& /*lasers*/) override {
    return octurn::to_record(report, origin, settings.depth_scale);
  }

 private:
  /// Reads the map of the sensor's depth error; null if there is none of the frames' size.
  /// @throws Error "scan-malformed"
  std::shared_ptr<const SensorMap> find_sensor_map() {
    const fs::path file = sensor_map_path(data_, serial());
    if (serial().empty() || !fs::exists(file)) {
      return nullptr;
    }
    auto map = std::make_shared<const SensorMap>(read_sensor_map(file));
    const Intrinsics& lens = rig_.sensor().intrinsics();
    return map->width == lens.width && map->height == lens.height ? map : nullptr;
  }

  Rig& rig_;
  fs::path data_;
};

class LaserCapture final : public Capture {
 public:
  LaserCapture(Rig& rig, fs::path data, const CalibrationStore& calibration)
      : rig_(rig), data_(std::move(data)), calibration_(calibration), configured_(*rig.laser()) {}

  std::string serial() override { return rig_.camera().serial(); }

  bool has_infrared() override { return false; }

  std::optional<Seen> read(const std::stop_token& stop) override {
    std::optional<TimedPicture> timed = rig_.camera().read(stop);
    return timed ? std::optional<Seen>(std::move(timed->picture)) : std::nullopt;
  }

  void use_stored(const ScanSettings& /*settings*/, const fs::path& begun) override {
    rig_.use_lens(stored_lens(begun));
    const PoseRecord pose =
        calibration_.records({.platform_from_sensor = configured_.platform_from_sensor}, serial())
            .front();
    rig_.use_pose(pose.platform_from_sensor, laser_camera(configured_).lasers);
    rig_.use_pose(pose.platform_from_sensor, pose.lasers);  // which may lack one
  }

  void keep_sensor_map(const fs::path& /*folder*/) override {}

  std::optional<TurnReport> measure_turn(const ScanSettings& settings, int threads,
                                         const std::stop_token& stop,
                                         const ScanObserver& observer) override {
    return measure_laser_turn(settings, data_, threads, rig_, stop, observer);
  }

  PoseRecord to_record(const CalibrationReport& report, PoseOrigin origin,
                       const ScanSettings& /*settings*/,
                       const std::vector<Laser>& lasers) override {
    return octurn::to_record(report, origin, serial(), lasers);
  }

 private:
  /// Returns the lens of a scan by the same camera; else the one in force.
  CameraLens stored_lens(const fs::path& begun) {
    CameraLens lens = lens_in_force(data_, serial(), told_lens(configured_));
    if (begun.empty()) {
      return lens;
    }
    const Scan scan = read_scan(begun);
    const bool is_same = scan.laser && scan.sensor_serial == serial() &&
                         scan.intrinsics.width == lens.intrinsics.width &&
                         scan.intrinsics.height == lens.intrinsics.height;
    return is_same ? CameraLens{.intrinsics = scan.intrinsics,
                                .k1 = scan.laser->k1,
                                .k2 = scan.laser->k2}
                   : lens;
  }

  Rig& rig_;
  fs::path data_;
  const CalibrationStore& calibration_;
  LaserSettings configured_;  // without what was measured since
};

}  // namespace

std::unique_ptr<Capture> make_capture(Rig& rig, fs::path data,
                                      const CalibrationStore& calibration) {
  if (rig.laser() != nullptr) {
    return std::make_unique<LaserCapture>(rig, std::move(data), calibration);
  }
  return std::make_unique<DepthCapture>(rig, std::move(data));
}

}  // namespace octurn
