// Worker: calibration of a camera's lens, and the lens and pose that a scan uses.

#include "calibration/lens_files.hpp"
#include "log.hpp"
#include "octurn/error.hpp"
#include "octurn/scan_folder.hpp"
#include "run/worker.hpp"

namespace octurn {
namespace {

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

}  // namespace

void Worker::carry_out(LensCommand& /*command*/, const std::stop_source& stop) {
  carry_out({.kind = CalibrationRun::Kind::lens, .phase = CalibrationRun::Phase::looking},
            [&](CalibrationRun& run) { find_lens(run, stop.get_token()); });
}

/// Takes views of a board until they suffice or `Scanner::solve_lens` is called; solves the lens.
void Worker::find_lens(CalibrationRun& run, const std::stop_token& stop) {
  if (!told_laser_) {
    throw Error(ErrorCode::sensor_other, "this rig has a depth sensor, and no camera with lasers",
                "A board is for the lens of such a camera.");
  }
  ports_.heartbeat.suspend();  // this takes as long as somebody holds a board
  Camera& camera = rig_.camera();
  if (camera.serial().empty()) {
    throw Error(ErrorCode::sensor_other,
                camera.name() + ": reports no serial number, under which its lens could be kept",
                "Take pictures of a board, and use octurn calibrate --board.");
  }
  const Intrinsics lens = told_laser_->lens;
  run.camera = camera.serial();
  const ShownBoard board(camera);
  BoardWatch watch(lens);
  while (!watch.is_complete()) {
    const std::optional<TimedPicture> timed = camera.read(stop);
    if (!timed) {
      break;
    }
    expect_size_for_lens(timed->picture, lens, camera.name());
    watch.see(timed->picture);
    show_picture(timed->picture);
    ports_.heartbeat.suspend();
    if (watch.look().taken > 0) {
      ports_.slot.report_lens_view();
    }
    run.look = watch.look();
    run.stop = watch.look().taken;
    run.stops = watch.look().wanted;
    ports_.board.set_calibration_run(run);
  }
  if (stop.stop_requested() &&
      (ports_.slot.scan_stop() != ScanStop::pause || ports_.slot.has_ended())) {
    run.state = CalibrationRun::State::cancelled;
    return;
  }
  run.phase = CalibrationRun::Phase::solving;
  ports_.board.set_calibration_run(run);
  run.lens = calibrate_lens(watch.views(), lens.width, lens.height);
  run.state = run.lens->accepted ? CalibrationRun::State::done : CalibrationRun::State::refused;
}

/// Returns the id of the scan whose lens the running one uses: a resumed scan keeps the lens that
/// it was begun with, and a scan of another pose uses that of the first scan. Empty for a first
/// one.
std::string Worker::first_scan() const {
  return job_.snapshots_done > 0 ? job_.id : job_.pose_of ? job_.pose_of->scan : "";
}

/// Sets the lens of the rig's camera.
/// @param begun  id of a scan whose lens is used if its camera is the same; empty: none
void Worker::use_lens(const std::string& begun) {
  if (!told_laser_) {
    return;
  }
  const std::string serial = rig_.camera().serial();
  CameraLens lens = lens_in_force(ports_.store.data(), serial, told_lens(*told_laser_));
  if (!begun.empty()) {
    const Scan scan = read_scan(ports_.store.folder(begun));
    if (scan.laser && scan.sensor_serial == serial &&
        scan.intrinsics.width == lens.intrinsics.width &&
        scan.intrinsics.height == lens.intrinsics.height) {
      lens = {.intrinsics = scan.intrinsics, .k1 = scan.laser->k1, .k2 = scan.laser->k2};
    }
  }
  rig_.use_lens(lens);
}

/// Sets the pose of the rig's camera and the planes of its lasers: those in force for this camera,
/// else the settings'.
void Worker::use_pose() {
  if (!told_laser_) {
    return;
  }
  const PoseRecord pose = ports_.calibration
                              .records({.platform_from_sensor = told_laser_->platform_from_sensor},
                                       rig_.camera().serial())
                              .front();
  rig_.use_pose(pose.platform_from_sensor, laser_camera(*told_laser_).lasers);
  rig_.use_pose(pose.platform_from_sensor, pose.lasers);
}

}  // namespace octurn
