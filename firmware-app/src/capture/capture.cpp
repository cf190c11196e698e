#include "capture/capture.hpp"

#include <cmath>
#include <cstddef>
#include <numbers>
#include <utility>

#include "calibration/lens_files.hpp"
#include "calibration/optics_files.hpp"
#include "calibration/sensor_map_files.hpp"
#include "capture/board_views.hpp"
#include "capture/last_look.hpp"
#include "capture/line_preview.hpp"
#include "capture/scan_of_rig.hpp"
#include "capture/take_pictures.hpp"
#include "log.hpp"
#include "octurn/error.hpp"
#include "octurn/scan_folder.hpp"
#include "octurn/sensor_map.hpp"
#include "store/stored_scan.hpp"

namespace octurn {
namespace {

namespace fs = std::filesystem;

/// Shows a moving board to a simulated camera during its lifetime.
class ShownBoard {
 public:
  explicit ShownBoard(Camera& camera) : camera_(camera) { camera_.show_board(true); }
  ~ShownBoard() { camera_.show_board(false); }
  ShownBoard(const ShownBoard&) = delete;
  ShownBoard& operator=(const ShownBoard&) = delete;

 private:
  Camera& camera_;
};

void expect_size_for_lens(const Picture& picture, const Intrinsics& lens,
                          const std::string& camera) {
  if (picture.width != lens.width || picture.height != lens.height) {
    throw Error(ErrorCode::sensor_other,
                camera +
                    ": its pictures have another size than laser.width and "
                    "laser.height say",
                "Correct them, or plug in the camera that they are of.");
  }
}

class DepthCapture final : public Capture {
 public:
  DepthCapture(Rig& rig, fs::path data) : Capture(rig), data_(std::move(data)) {}

  SensorInfo sensor() override {
    DepthSensor& sensor = rig_.sensor();
    return {
        .name = sensor.name(), .serial = sensor.serial(), .has_infrared = sensor.has_infrared()};
  }

  std::optional<SeenImage> read(const std::stop_token& stop) override {
    std::optional<TimedFrame> timed = rig_.sensor().read(stop);
    return timed ? std::optional<SeenImage>(std::move(timed->frame)) : std::nullopt;
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

  Scan plan(const ScanSettings& /*settings*/) override { return {}; }

  void begin(Scan& scan, const ScanSettings& settings, const fs::path& folder) override {
    scan = scan_of_sensor(rig_, settings);
    if (const auto map = folder / sensor_map_file; fs::exists(map)) {
      use_sensor_map(scan, map);
    }
  }

  bool resume(const Scan& scan, const SnapshotSource& stored) override {
    first_readings_ = readings_in(stored.read(0).frame);
    // The next stop shows whether steps were lost meanwhile.
    const Turntable& turntable = rig_.turntable();
    const double turned = std::remainder(
        rig_.platform_angle_deg() / 360 - scan.shots.back().angle / (2 * std::numbers::pi), 1);
    rig_.seen_stop() = {
        .image = stored.read(scan.shots.size() - 1).frame,
        .position = turntable.position() - std::llround(turned * turntable.steps_per_turn())};
    return true;
  }

  std::optional<TakenStop> take(const Stop& at, double angle, const ScanSettings& settings,
                                const fs::path& folder, Scan& scan, const std::stop_token& stop,
                                const ScanObserver& observer) override {
    std::optional<DepthFrame> frame = take_depth_image(rig_, at, settings, stop, observer);
    if (!frame) {
      return std::nullopt;
    }
    const std::ptrdiff_t readings = readings_in(*frame);
    first_readings_ = at.index == 0 ? readings : first_readings_;
    expect_coverage(readings, first_readings_, scan.sensor_name);
    const Shot shot{
        .file = shot_file(at.index), .angle = angle, .lost_share = rig_.take_lost_share()};
    store_snapshot(folder, scan, shot, *frame);
    return TakenStop{.frame = std::move(frame)};
  }

  std::optional<DepthFrame> look_again(const ScanSettings& settings, const std::stop_token& stop,
                                       const ScanObserver& observer) override {
    return retake_first_stop(rig_, settings, stop, observer);
  }

  bool has_sensor_of(const Scan& scan, const ScanSettings& settings) override {
    return have_same_sensor(
        {.intrinsics = to_intrinsics(rig_.sensor(), scan.optics.has_value(), settings)}, scan);
  }

  std::optional<TurnReport> measure_turn(const ScanSettings& settings, int threads,
                                         const std::stop_token& stop,
                                         const ScanObserver& observer) override {
    return octurn::measure_turn(settings, find_sensor_map(), threads, rig_, stop, observer);
  }

  std::optional<BoardResult> measure_board(double square, const std::stop_token& stop,
                                           const BoardObserver& observer) override {
    DepthSensor& sensor = rig_.sensor();
    if (sensor.serial().empty()) {
      throw Error(
          ErrorCode::sensor_other,
          sensor.name() + ": reports no serial number, under which its optics could be kept",
          "Measure a known length instead.", {{"no_serial", sensor.name()}});
    }
    const std::vector<DepthBoardView> views = take_board_views(sensor, stop, observer.on_picture);
    if (!observer.on_solving()) {
      return std::nullopt;
    }
    const Intrinsics& lens = sensor.intrinsics();
    DepthOpticsReport report = calibrate_depth_optics(views, lens.width, lens.height, square);
    if (!report.lens.accepted) {
      return BoardResult{.lens = std::move(report.lens)};
    }
    log::info("calibration", "the infrared picture is shifted by " +
                                 std::to_string(report.shift.x()) + ", " +
                                 std::to_string(report.shift.y()) + " pixels");
    return BoardResult{.lens = std::move(report.lens), .optics = report.optics};
  }

  PoseRecord to_record(const CalibrationReport& report, PoseOrigin origin,
                       const ScanSettings& settings,
                       const std::vector<Laser>& /*lasers*/) override {
    return octurn::to_record(report, origin, settings.depth_scale);
  }

 private:
  std::string serial() { return rig_.sensor().serial(); }

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

  fs::path data_;
  std::ptrdiff_t first_readings_ = 0;  // in the first snapshot of the scan
};

class LaserCapture final : public Capture {
 public:
  LaserCapture(Rig& rig, fs::path data, const CalibrationStore* calibration)
      : Capture(rig),
        data_(std::move(data)),
        calibration_(calibration),
        configured_(*rig.laser()) {}

  SensorInfo sensor() override {
    return {.name = rig_.camera().name(), .serial = rig_.camera().serial()};
  }

  std::optional<SeenImage> read(const std::stop_token& stop) override {
    std::optional<TimedPicture> timed = rig_.camera().read(stop);
    return timed ? std::optional<SeenImage>(std::move(timed->picture)) : std::nullopt;
  }

  void use_stored(const ScanSettings& /*settings*/, const fs::path& begun) override {
    rig_.use_lens(stored_lens(begun));
    const PoseRecord pose =
        calibration_->records({.platform_from_sensor = configured_.platform_from_sensor}, serial())
            .front();
    rig_.use_pose(pose.platform_from_sensor, laser_camera(configured_).lasers);
    rig_.use_pose(pose.platform_from_sensor, pose.lasers);  // which may lack one
  }

  void keep_sensor_map(const fs::path& /*folder*/) override {}

  Scan plan(const ScanSettings& settings) override { return scan_of_lasers(rig_, settings); }

  void begin(Scan& scan, const ScanSettings& /*settings*/, const fs::path& /*folder*/) override {
    const auto [name, serial, has_infrared] = sensor();
    scan.sensor_name = name;
    scan.sensor_serial = serial;
  }

  bool resume(const Scan& /*scan*/, const SnapshotSource& /*stored*/) override { return false; }

  std::optional<TakenStop> take(const Stop& at, double angle, const ScanSettings& /*settings*/,
                                const fs::path& folder, Scan& scan, const std::stop_token& stop,
                                const ScanObserver& observer) override {
    return take_stop(rig_, at, angle, folder, scan, stop, observer) ? std::optional(TakenStop{})
                                                                    : std::nullopt;
  }

  std::optional<DepthFrame> look_again(const ScanSettings& /*settings*/,
                                       const std::stop_token& /*stop*/,
                                       const ScanObserver& /*observer*/) override {
    return std::nullopt;
  }

  bool has_sensor_of(const Scan& scan, const ScanSettings& settings) override {
    return have_same_sensor(plan(settings), scan);
  }

  std::optional<TurnReport> measure_turn(const ScanSettings& settings, int threads,
                                         const std::stop_token& stop,
                                         const ScanObserver& observer) override {
    return measure_laser_turn(settings, data_, threads, rig_, stop, observer);
  }

  std::optional<BoardResult> measure_board(double /*square*/, const std::stop_token& stop,
                                           const BoardObserver& observer) override {
    Camera& camera = rig_.camera();
    if (camera.serial().empty()) {
      throw Error(ErrorCode::sensor_other,
                  camera.name() + ": reports no serial number, under which its lens could be kept",
                  "Take pictures of a board, and use octurn calibrate --board.",
                  {{"camera_no_serial", camera.name()}});
    }
    const Intrinsics lens = rig_.laser()->lens;
    const ShownBoard board(camera);
    BoardWatch watch(lens);
    while (!watch.is_complete()) {
      const std::optional<TimedPicture> timed = camera.read(stop);
      if (!timed) {
        break;
      }
      expect_size_for_lens(timed->picture, lens, camera.name());
      watch.see(timed->picture);
      observer.on_picture(timed->picture, watch.look());
    }
    return observer.on_solving()
               ? std::optional(
                     BoardResult{.lens = calibrate_lens(watch.views(), lens.width, lens.height)})
               : std::nullopt;
  }

  PoseRecord to_record(const CalibrationReport& report, PoseOrigin origin,
                       const ScanSettings& /*settings*/,
                       const std::vector<Laser>& lasers) override {
    return octurn::to_record(report, origin, serial(), lasers);
  }

 private:
  std::string serial() { return rig_.camera().serial(); }

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

  fs::path data_;
  const CalibrationStore* calibration_;
  LaserSettings configured_;  // without what was measured since
};

}  // namespace

std::unique_ptr<Capture> make_capture(Rig& rig, fs::path data,
                                      const CalibrationStore* calibration) {
  if (rig.laser() != nullptr) {
    return std::make_unique<LaserCapture>(rig, std::move(data), calibration);
  }
  return std::make_unique<DepthCapture>(rig, std::move(data));
}

void expect_same_sensor(const Scan& scan, const ScanSettings& settings, Capture& capture) {
  if (!capture.has_sensor_of(scan, settings)) {
    throw Error(ErrorCode::sensor_other,
                "this scan was begun with another sensor: " + scan.sensor_name,
                "Plug in the one that it was begun with.", {{"begun_with", scan.sensor_name}});
  }
}

}  // namespace octurn
