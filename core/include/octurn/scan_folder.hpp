#pragma once

#include <Eigen/Geometry>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <stop_token>
#include <string>
#include <string_view>
#include <vector>

#include "octurn/reconstruct.hpp"
#include "octurn/sensor_map.hpp"
#include "octurn/snapshot.hpp"

namespace octurn {

/// A line laser: its light is a plane, which draws a line on a surface.
struct Laser {
  std::string name = {};
  /// Of length one, optical frame. The plane is normal . p = distance.
  Eigen::Vector3d normal = Eigen::Vector3d::UnitX();
  double distance = 0;                         ///< metres
  std::optional<Eigen::Vector3d> source = {};  ///< metres, optical frame: origin of its light
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
  /// Of a scan by laser line, in place of `file`: the picture without laser light, then one for
  /// each laser, in the order of `LaserCamera::lasers`.
  std::vector<std::string> pictures = {};
  double angle = 0.0;  ///< of the platform, radians, counter-clockwise seen from above
  /// Radians: how much further the platform stood, as the scan's snapshots show.
  double slipped = 0;
  int pose = 0;  ///< index in the scan's poses
  /// Of the sensor's packets, those that were lost on USB while the snapshot was taken; 0 to 1.
  double lost_share = 0;
  /// Optical frame to the object's frame, metres; if present, it replaces angle and calibration.
  std::optional<Eigen::Isometry3d> object_from_sensor = {};
};

/// A pose that was solved from a scan's own snapshots; see `CalibrationReport`.
struct SolvedPose {
  Eigen::Isometry3d platform_from_sensor = Eigen::Isometry3d::Identity();  ///< metres
  double position_sigma = 0;                                               ///< metres
  double direction_sigma = 0;                                              ///< radians
  double before =
      0;  ///< metres: median distance between two stops' surfaces with the configured pose
  double after = 0;                ///< the same with this pose
  std::vector<Laser> lasers = {};  ///< of a scan by laser line: solved planes, without `source`
  std::optional<SolvedOptics> optics = {};  ///< of a depth sensor, if they replace what was known
};

/// One of several poses of the object on the platform, each with a turn of snapshots.
struct ScanPose {
  /// Platform frame of this pose at angle 0 to the object's frame, which is the first pose's
  /// platform frame; metres. Nothing: not known yet.
  std::optional<Eigen::Isometry3d> object_from_platform = {};
  Eigen::Isometry3d platform_from_sensor =
      Eigen::Isometry3d::Identity();  ///< as configured, metres
  std::optional<SolvedPose> solved = {};
  Box clip = {};  ///< metres, platform frame of this pose
};

/// The depths of published Kinects are a per cent or two off.
inline constexpr double unknown_scale_sigma = 0.01;

/// The content of `scan.json` (format "octurn-scan", version 1 or 2).
struct Scan {
  std::string sensor_name = {};
  std::string sensor_serial = {};         ///< empty if unknown
  Intrinsics intrinsics = {};             ///< `depth_unit` is not used by laser line
  std::optional<LaserCamera> laser = {};  ///< nothing: a depth sensor
  /// Of a depth sensor, if measured before the scan. Sigmas of 0: the file does not have them.
  std::optional<SolvedOptics> optics = {};
  double scale_sigma = unknown_scale_sigma;  ///< of the depths' scale, relative
  std::optional<double> sensor_on_for = {};  ///< seconds that the sensor had been on, if known
  /// As configured when the scan was taken; metres.
  Eigen::Isometry3d platform_from_sensor = Eigen::Isometry3d::Identity();
  std::optional<SolvedPose> solved = {};
  Box clip = {};  ///< metres, platform frame
  std::vector<Shot> shots = {};
  std::vector<ScanPose> poses = {};  ///< empty: one pose, with the members above (version 1)
  /// Applied to each snapshot when it is read; null: none is applied. Not stored in `scan.json`.
  std::shared_ptr<const SensorMap> sensor_map = {};
};

/// The file of the sensor's map in a scan folder.
inline constexpr const char* sensor_map_file = "sensor-map.png";

/// The sensor's pose for models: the solved one, else the configured one.
inline const Eigen::Isometry3d& model_pose(const Scan& scan) {
  return scan.solved ? scan.solved->platform_from_sensor : scan.platform_from_sensor;
}

/// The lasers with their planes for models: the solved ones, else the configured ones.
/// @param solved  of the scan, or of one of its poses
std::vector<Laser> model_lasers(const LaserCamera& camera, const std::optional<SolvedPose>& solved);

/// A shot's pose for models: optical frame to the object's frame, metres.
/// @throws Error "scan-malformed"  with the pose's number, if its `object_from_platform` is unknown
Eigen::Isometry3d model_pose(const Scan& scan, const Shot& shot);

/// For `ReconstructOptions::placements`: empty for a scan of one pose. @throws Error  as above
std::vector<Placement> placements(const Scan& scan);

/// The clip box of the scan's models, metres, object's frame: it encloses the boxes of all poses.
/// @throws Error  as above
Box model_clip(const Scan& scan);

/// The traits of the scan's sensor.
const SensorTraits& sensor_traits(const Scan& scan);

/// Adapts options to the scan: sets the placements of its poses and the sensor's truncation; for a
/// scan by laser line it adds the memory of its lines to `program_memory`.
/// @throws Error  as `model_pose`
void fit_to_scan(ReconstructOptions& options, const Scan& scan);

/// The options by which `octurn reconstruct` makes the scan's model, if it is given none: `solid`
/// within the clip boxes of all poses, and finer by laser line. Like all models, it is made with
/// `model_pose`: a pose that the scan does not have yet is not solved.
///
/// For a scan with free poses the method is `intersection`, and its reconstruction is one of
/// `make_tiled_reconstructor`.
/// @throws Error  as `model_pose`
ReconstructOptions model_options(const Scan& scan);

/// Whether all shots belong to one turn of the platform, with one calibration and clip box.
bool is_one_turn(const Scan& scan);

/// Whether each shot has its own pose: it is a scan of a space, without a platform.
bool has_free_poses(const Scan& scan);

/// The clip box of a scan with free poses that has no other: larger than any scan, metres.
inline const Box everywhere{.min = Eigen::Vector3d::Constant(-1e6),
                            .max = Eigen::Vector3d::Constant(1e6)};

/// Parses and checks the text of a `scan.json`. Unknown keys are ignored.
///
/// @throws Error "scan-malformed"  with the key and what is wrong with it: missing, of the wrong
///                                 type, an unknown version, a file outside the folder, a matrix
///                                 that is not rigid
/// @throws Error "scan-empty"      if it lists no snapshots
Scan parse_scan(std::string_view text);

/// Reads `folder/scan.json`, and `folder/sensor-map.png` if it exists.
/// @throws Error  as `parse_scan`
/// @throws Error "scan-missing"    if there is no scan.json
/// @throws Error "scan-malformed"  also if the map cannot be used
Scan read_scan(const std::filesystem::path& folder);

/// Replaces the scan's sensor map by that of a file.
/// @throws Error "scan-malformed"  if the file is not a map, or one of another size
void use_sensor_map(Scan& scan, const std::filesystem::path& file);

/// The optics of a shot for models: solved, else known before the scan; nothing: the sensor's own.
std::optional<SensorOptics> model_optics(const Scan& scan, const Shot& shot);

/// The pinhole camera of a shot's snapshot.
Intrinsics model_intrinsics(const Scan& scan, const Shot& shot);

/// Makes a shot's snapshot from its depth image: applies the sensor map and `model_optics`. Its
/// pose is `model_pose`.
///
/// The map is one of the sensor's pixels: it goes before distortion, and the depth scale, which
/// changes its errors by as little, is the depth unit's.
Snapshot make_snapshot(DepthFrame frame, const Scan& scan, const Shot& shot);

/// Reads the depth image of one shot, and makes its snapshot.
///
/// @throws Error "scan-malformed"      if it is a scan by laser line, which has no depth images
/// @throws Error "scan-missing"        if there is no such file
/// @throws Error "snapshot-malformed"  if it is not a 16-bit greyscale PNG, is damaged, or has
///                                     another size than `scan.json` says
Snapshot read_snapshot(const std::filesystem::path& folder, const Scan& scan, const Shot& shot);

/// The snapshots of a scan folder, read from the disk at each call. By laser line, each picture is
/// read once and its line is kept, about 10 kB for each stop and laser.
///
/// @param stop  once requested, a read throws `Stopped`
SnapshotSource stored_snapshots(const std::filesystem::path& folder, const Scan& scan,
                                const std::stop_token& stop = {});

/// Writes `folder/scan.json`, whole or not at all, and returns when it is on the disk. Writes
/// version 1, unless the scan has several poses, a shot has its own pose, or it is by laser line.
/// @throws Error "disk-full", "write-failed"
void write_scan(const std::filesystem::path& folder, const Scan& scan);

/// Writes a solved pose into `folder/scan.json`, whole or not at all. All other keys stay, and so
/// do the calibrations of single poses.
/// @param slipped  radians, `Shot::slipped` of each shot; empty: the platform did not slip
/// @throws Error  as `read_scan` and `write_scan`
void write_solved_pose(const std::filesystem::path& folder, const SolvedPose& solved,
                       std::span<const double> slipped = {});

/// Writes a clip box into `folder/scan.json`, whole or not at all. All other keys stay.
/// @throws Error  as `read_scan` and `write_scan`
void write_clip(const std::filesystem::path& folder, const Box& clip);

/// The file of the shot with that index, such as "snapshots/000.png".
std::string shot_file(int index);

}  // namespace octurn
