#include <Eigen/Geometry>
#include <algorithm>
#include <string>

#include "octurn/error.hpp"
#include "octurn/scan_folder.hpp"
#include "octurn/snapshot.hpp"

namespace octurn {
namespace {

/// The placement of a pose. @throws Error  with the pose's number, if it is not known yet
const Eigen::Isometry3d& known(const Scan& scan, int pose) {
  const auto& placement = scan.poses[static_cast<std::size_t>(pose)].object_from_platform;
  if (!placement) {
    throw Error(ErrorCode::scan_malformed,
                "scan.json: how the object lay in pose " + std::to_string(pose) +
                    " is not known yet: \"poses[" + std::to_string(pose) +
                    "].object_from_platform\" is null",
                "Find it out by octurn merge.");
  }
  return *placement;
}

}  // namespace

std::vector<Laser> model_lasers(const LaserCamera& camera,
                                const std::optional<SolvedPose>& solved) {
  std::vector<Laser> lasers = camera.lasers;
  if (!solved) {
    return lasers;
  }
  for (Laser& laser : lasers) {
    const auto found = std::ranges::find(solved->lasers, laser.name, &Laser::name);
    if (found != solved->lasers.end()) {
      laser.normal = found->normal;
      laser.distance = found->distance;
    }
  }
  return lasers;
}

Eigen::Isometry3d model_pose(const Scan& scan, const Shot& shot) {
  if (shot.object_from_sensor) {
    return *shot.object_from_sensor;
  }
  if (scan.poses.empty()) {
    return object_from_sensor(model_pose(scan), shot.angle + shot.slipped);
  }
  const ScanPose& pose = scan.poses[static_cast<std::size_t>(shot.pose)];
  const auto& sensor = pose.solved ? pose.solved->platform_from_sensor : pose.platform_from_sensor;
  return known(scan, shot.pose) * object_from_sensor(sensor, shot.angle + shot.slipped);
}

std::optional<SensorOptics> model_optics(const Scan& scan, const Shot& shot) {
  const auto& solved =
      scan.poses.empty() ? scan.solved : scan.poses[static_cast<std::size_t>(shot.pose)].solved;
  const auto& optics = solved && solved->optics ? solved->optics : scan.optics;
  return optics ? std::optional(optics->value) : std::nullopt;
}

Intrinsics model_intrinsics(const Scan& scan, const Shot& shot) {
  const auto optics = model_optics(scan, shot);
  return optics ? rectified(scan.intrinsics, *optics) : scan.intrinsics;
}

std::vector<Placement> placements(const Scan& scan) {
  std::vector<Placement> all;
  for (std::size_t i = 0; i < scan.poses.size(); ++i) {
    all.push_back(
        {.object_from_platform = known(scan, static_cast<int>(i)), .clip = scan.poses[i].clip});
  }
  return all;
}

Box model_clip(const Scan& scan) {
  const std::vector<Placement> all = placements(scan);
  if (all.empty()) {
    return scan.clip;
  }
  Eigen::AlignedBox3d box;
  for (const Placement& placement : all) {
    const Eigen::AlignedBox3d own(placement.clip.min, placement.clip.max);
    box.extend(own.transformed(placement.object_from_platform));
  }
  return {.min = box.min(), .max = box.max()};
}

bool is_one_turn(const Scan& scan) {
  return scan.poses.empty() && std::ranges::none_of(scan.shots, [](const Shot& shot) {
           return shot.object_from_sensor.has_value();
         });
}

bool has_free_poses(const Scan& scan) {
  return !scan.laser && scan.poses.empty() && std::ranges::all_of(scan.shots, [](const Shot& shot) {
    return shot.object_from_sensor.has_value();
  });
}

}  // namespace octurn
