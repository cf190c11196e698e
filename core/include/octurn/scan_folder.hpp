#pragma once

#include <Eigen/Geometry>
#include <filesystem>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <string_view>
#include <vector>

#include "octurn/reconstruct.hpp"
#include "octurn/sensor_map.hpp"
#include "octurn/snapshot.hpp"

namespace octurn {

/// A laser whose light is a plane, which shows as a line on what it meets.
struct Laser {
  std::string name = {};
  /// Of length one. The plane holds the points p of the optical frame with normal . p = distance.
  Eigen::Vector3d normal = Eigen::Vector3d::UnitX();
  double distance = 0;                         ///< metres
  std::optional<Eigen::Vector3d> source = {};  ///< metres, optical frame: where its light is from
};

/// A camera with line lasers, in place of a depth sensor.
struct LaserCamera {
  /// Brown's radial distortion of normalised coordinates: x_d = x (1 + k1 r^2 + k2 r^4).
  double k1 = 0;
  double k2 = 0;
  std::vector<Laser> lasers = {};  ///< at least one
};

/// An entry of a scan's list of snapshots.
struct Shot {
  std::string file = {};  ///< the depth image, relative to the scan folder
  /// Of a scan by laser line, in its place: the picture without a laser, then one with each laser
  /// on, in their order.
  std::vector<std::string> pictures = {};
  double angle = 0.0;  ///< of the platform, radians, counter-clockwise seen from above
  int pose = 0;        ///< index in the scan's poses
  /// Metres, in place of what angle and calibration tell, if it is there.
  std::optional<Eigen::Isometry3d> object_from_sensor = {};
};

/// A pose that was solved from a scan's own snapshots, as `CalibrationReport` has it.
struct SolvedPose {
  Eigen::Isometry3d platform_from_sensor = Eigen::Isometry3d::Identity();  ///< metres
  double position_sigma = 0;                                               ///< metres
  double direction_sigma = 0;                                              ///< radians
  double before = 0;  ///< metres, that two stops disagree about the object with the told pose
  double after = 0;   ///< the same with this one
  std::vector<Laser> lasers = {};  ///< of a scan by laser line: their planes, without sources
};

/// One of several ways that the object lay on the platform, each for a turn of snapshots.
struct ScanPose {
  /// Platform frame of this pose, at angle 0, to the object's frame, which is that of the first
  /// pose; metres. None: not known yet.
  std::optional<Eigen::Isometry3d> object_from_platform = {};
  Eigen::Isometry3d platform_from_sensor = Eigen::Isometry3d::Identity();  ///< as told, metres
  std::optional<SolvedPose> solved = {};
  Box clip = {};  ///< metres, platform frame of this pose
};

/// What `scan.json` says (format "octurn-scan", version 1 or 2).
struct Scan {
  std::string sensor_name = {};
  std::string sensor_serial = {};         ///< empty if it tells none
  Intrinsics intrinsics = {};             ///< of a camera with lasers without a depth unit
  std::optional<LaserCamera> laser = {};  ///< none: the sensor measures depth
  /// As the rig was told when the scan was taken, metres.
  Eigen::Isometry3d platform_from_sensor = Eigen::Isometry3d::Identity();
  std::optional<SolvedPose> solved = {};
  Box clip = {};  ///< metres, platform frame
  std::vector<Shot> shots = {};
  std::vector<ScanPose> poses = {};  ///< empty: one, as above and as version 1 has it
  /// What snapshots are freed from when they are read; none: they stay as the sensor gave them.
  /// It is no part of `scan.json`.
  std::shared_ptr<const SensorMap> sensor_map = {};
};

/// The map of the scan's sensor, in a scan folder.
inline constexpr const char* sensor_map_file = "sensor-map.png";

/// The pose of the sensor that models are made with: the solved one, else the one that the rig was
/// told.
inline const Eigen::Isometry3d& model_pose(const Scan& scan) {
  return scan.solved ? scan.solved->platform_from_sensor : scan.platform_from_sensor;
}

/// The lasers with the planes that models are made with: the solved ones, else those that the rig
/// was told.
/// @param solved  of the scan, or of one of its poses
std::vector<Laser> model_lasers(const LaserCamera& camera, const std::optional<SolvedPose>& solved);

/// The pose that a shot has in models: optical frame to the object's frame, metres.
/// @throws Error "scan-malformed"  that says the pose's number, if how the object lay is not known
Eigen::Isometry3d model_pose(const Scan& scan, const Shot& shot);

/// How the object lay in each pose; empty for a scan of one. @throws Error  as above
std::vector<Placement> placements(const Scan& scan);

/// The clip box of the scan's models, metres, object's frame: of several poses, around those of
/// all.
/// @throws Error  as above
Box model_clip(const Scan& scan);

/// Sets what a model's options owe to the scan's sensor: of one by laser line the truncation, and
/// the memory that its lines take.
void fit_to_sensor(ReconstructOptions& options, const Scan& scan);

/// Whether all shots are of one turn of the platform, with one calibration and clip box.
bool is_one_turn(const Scan& scan);

/// Reads and checks the text of a `scan.json`. Keys that are not of the contract are passed over.
///
/// @throws Error "scan-malformed"  that names the key and what is wrong with it: missing, of the
///                                 wrong kind, another version, a file outside the folder, a matrix
///                                 that is no rotation
/// @throws Error "scan-empty"      if it lists no snapshots
Scan parse_scan(std::string_view text);

/// The same from `folder/scan.json`, with `folder/sensor-map.png` if there is one.
/// @throws Error "scan-missing"          also if there is no scan.json
/// @throws Error "scan-malformed"  if there is a map, and it cannot be used
Scan read_scan(const std::filesystem::path& folder);

/// Has the snapshots of a scan corrected by that map, in place of its own.
/// @throws Error "scan-malformed"  if it is no map, or one of another size
void use_sensor_map(Scan& scan, const std::filesystem::path& file);

/// A depth image of the scan's sensor, corrected by its sensor map if it has one.
DepthFrame corrected(DepthFrame frame, const Scan& scan);

/// Reads the depth image of one shot, corrected by the scan's sensor map; its pose is `model_pose`.
///
/// @throws Error "scan-malformed"      if it is a scan by laser line, which has none
/// @throws Error "scan-missing"        if there is no such file
/// @throws Error "snapshot-malformed"  if it is no 16-bit greyscale PNG, is damaged or cut short,
/// or
///                                     has another size than `scan.json` says
Snapshot read_snapshot(const std::filesystem::path& folder, const Scan& scan, const Shot& shot);

/// The snapshots of a scan folder, read from the disk each time they are asked for. Of a scan by
/// laser line each picture is read once: its lines are kept, about 10 kB of each stop and laser.
///
/// @param stop  once requested, a read throws `Stopped`
SnapshotSource stored_snapshots(const std::filesystem::path& folder, const Scan& scan,
                                const std::stop_token& stop = {});

/// Writes `folder/scan.json`, whole or not at all, and returns when it is on the disk. Version 1,
/// unless the scan has poses or a shot its own pose.
/// @throws Error "disk-full", "write-failed"
void write_scan(const std::filesystem::path& folder, const Scan& scan);

/// Writes a solved pose into `folder/scan.json`, whole or not at all. All its other keys stay.
/// Poses with a calibration of their own keep that.
/// @throws Error  as `read_scan` and `write_scan`
void write_solved_pose(const std::filesystem::path& folder, const SolvedPose& solved);

/// The file of the shot of that index: "snapshots/000.png".
std::string shot_file(int index);

}  // namespace octurn
