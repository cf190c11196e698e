#include "octurn/scan_folder.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <span>
#include <system_error>
#include <utility>

#include "io/pose_json.hpp"
#include "io/sensor_json.hpp"
#include "octurn/error.hpp"
#include "octurn/file.hpp"
#include "octurn/json_object.hpp"
#include "octurn/png.hpp"
#include "octurn/units.hpp"

namespace octurn {
namespace {

using nlohmann::json;

/// The default root cube of models: the clip box of a scan by laser line that has none.
const Box whole_root{.min = {-0.5, -0.5, 0}, .max = {0.5, 0.5, 1}};

Shot shot_from(const JsonValue& value, int version, const std::optional<LaserCamera>& laser) {
  JsonObject keys(value);
  Shot shot;
  if (laser) {
    shot.pictures = pictures_from(keys.at("files"), *laser);
  } else {
    shot.file = file_inside(keys.at("file"), "a file in the scan's folder");
  }
  if (const auto lost = keys.value("lost_packets_percent")) {
    shot.lost_share = lost->number(0, 100) / 100;
  }
  if (const auto slipped = keys.value("slipped_deg")) {
    shot.slipped = radians_from_degrees(slipped->number());
  }
  if (version == 1) {
    shot.angle = radians_from_degrees(keys.at("angle_deg").number());
    return shot;
  }
  shot.pose = keys.whole_number("pose", 0, max_poses - 1).value_or(0);
  const auto matrix = keys.value("object_from_sensor");
  const auto angle = keys.value("angle_deg");
  if (matrix && angle) {
    value.refuse("a snapshot with either \"angle_deg\" or \"object_from_sensor\"");
  }
  if (matrix) {
    shot.object_from_sensor = pose_from(*matrix);
  } else {
    shot.angle = radians_from_degrees(keys.at("angle_deg").number());
  }
  return shot;
}

/// Turns a scan with a single pose, whose frame is the object's, into one without poses, as in
/// version 1.
void take_single_pose(Scan& scan) {
  if (scan.poses.size() == 1 &&
      scan.poses.front().object_from_platform->isApprox(Eigen::Isometry3d::Identity())) {
    const ScanPose pose = scan.poses.front();
    scan.platform_from_sensor = pose.platform_from_sensor;
    scan.solved = pose.solved;
    scan.clip = pose.clip;
    scan.poses.clear();
  }
}

/// Reads calibration, clip box and poses. Calibration and clip box may be missing if each snapshot
/// has its own pose.
void read_rig(JsonObject& root, int version, Scan& scan) {
  const bool all_told = std::ranges::all_of(
      scan.shots, [](const Shot& shot) { return shot.object_from_sensor.has_value(); });
  const auto calibration = root.value("calibration");
  const auto clip = root.value("clip_m");
  if (calibration || !all_told) {
    RigPose rig = calibration_from(root.at("calibration"));
    scan.platform_from_sensor = rig.platform_from_sensor;
    scan.solved = rig.solved;
  }
  scan.clip = clip || !all_told ? box_from(root.at("clip_m"))
              : scan.laser      ? whole_root
                                : everywhere;
  if (const auto poses = version > 1 ? root.value("poses") : std::nullopt) {
    scan.poses = poses_from(*poses, scan);
  }
}

/// @throws Error  that names the first solved laser that the sensor does not have
void expect_lasers(const Scan& scan, const std::optional<SolvedPose>& solved) {
  if (!scan.laser || !solved) {
    return;
  }
  for (const Laser& laser : solved->lasers) {
    if (std::ranges::count(scan.laser->lasers, laser.name, &Laser::name) == 0) {
      throw Error(ErrorCode::scan_malformed, "\"solved.lasers\" has \"" + laser.name +
                                                 "\", which is none of \"sensor.lasers\"");
    }
  }
}

/// @throws Error  that names the first snapshot of a pose that is not listed
void expect_poses(const Scan& scan) {
  const std::size_t poses = std::max<std::size_t>(scan.poses.size(), 1);
  for (std::size_t i = 0; i < scan.shots.size(); ++i) {
    if (static_cast<std::size_t>(scan.shots[i].pose) >= poses) {
      throw Error(ErrorCode::scan_malformed, "\"snapshots[" + std::to_string(i) + "].pose\" is " +
                                                 std::to_string(scan.shots[i].pose) +
                                                 ": \"poses\" has " + std::to_string(poses));
    }
  }
}

Scan scan_from(const json& document) {
  JsonObject root(document, ErrorCode::scan_malformed, "");
  if (const JsonValue format = root.at("format"); format.text() != "octurn-scan") {
    format.refuse("\"octurn-scan\"");
  }
  const JsonValue version = root.at("version");
  if (version.number() != 1 && version.number() != 2) {
    version.refuse("1 or 2, which this program reads");
  }
  const int number = version.whole_number(1, 2);
  SensorJson sensor = sensor_from(root.at("sensor"));
  if (sensor.laser && number < 2) {
    version.refuse("2, as the sensor's kind is \"laser-line\"");
  }
  Scan scan{.sensor_name = std::move(sensor.name),
            .sensor_serial = std::move(sensor.serial),
            .intrinsics = sensor.intrinsics,
            .laser = std::move(sensor.laser),
            .optics = sensor.optics,
            .scale_sigma = sensor.scale_sigma,
            .sensor_on_for = sensor.on_for};
  for (const JsonValue& shot : root.at("snapshots").elements()) {
    scan.shots.push_back(shot_from(shot, number, scan.laser));
  }
  if (scan.shots.empty()) {
    throw Error(ErrorCode::scan_empty, "\"snapshots\" is empty: there is nothing to reconstruct");
  }
  read_rig(root, number, scan);
  expect_poses(scan);
  expect_lasers(scan, scan.solved);
  for (const ScanPose& pose : scan.poses) {
    expect_lasers(scan, pose.solved);
  }
  take_single_pose(scan);
  return scan;
}

json shot_json(const Shot& shot, const std::optional<LaserCamera>& laser) {
  json value =
      laser ? json{{"files", pictures_json(shot.pictures, *laser)}} : json{{"file", shot.file}};
  if (shot.object_from_sensor) {
    value["object_from_sensor"] = to_json(*shot.object_from_sensor);
  } else {
    value["angle_deg"] = degrees_from_radians(shot.angle);
  }
  if (shot.slipped != 0) {
    value["slipped_deg"] = degrees_from_radians(shot.slipped);
  }
  if (shot.pose != 0) {
    value["pose"] = shot.pose;
  }
  if (shot.lost_share > 0) {
    value["lost_packets_percent"] = 100 * shot.lost_share;
  }
  return value;
}

/// Bytes of a device's name that are not UTF-8 are replaced.
void write_document(const std::filesystem::path& folder, const json& document) {
  write_file(folder / "scan.json",
             document.dump(1, ' ', false, json::error_handler_t::replace) + "\n");
}

}  // namespace

Scan parse_scan(std::string_view text) {
  try {
    return scan_from(parse_json(text, ErrorCode::scan_malformed, "it"));
  } catch (const Error& error) {
    throw Error(error.code(), std::string("scan.json: ") + error.what(),
                error.code() == ErrorCode::scan_malformed
                    ? "The folder is not a scan that this version can read."
                    : "");
  }
}

Scan read_scan(const std::filesystem::path& folder) {
  Scan scan = parse_scan(read_scan_file(folder / "scan.json"));
  const std::filesystem::path map = folder / sensor_map_file;
  if (std::error_code ignored; std::filesystem::exists(map, ignored)) {
    use_sensor_map(scan, map);
  }
  return scan;
}

void use_sensor_map(Scan& scan, const std::filesystem::path& file) {
  scan.sensor_map = std::make_shared<const SensorMap>(read_sensor_map(file, scan.intrinsics));
}

Snapshot make_snapshot(DepthFrame frame, const Scan& scan, const Shot& shot) {
  Snapshot snapshot{.frame = scan.sensor_map ? corrected(std::move(frame), *scan.sensor_map,
                                                         scan.intrinsics.depth_unit)
                                             : std::move(frame),
                    .intrinsics = model_intrinsics(scan, shot),
                    .object_from_sensor = model_pose(scan, shot),
                    .pose = shot.pose};
  if (const auto optics = model_optics(scan, shot)) {
    snapshot.frame = rectified(std::move(snapshot.frame), scan.intrinsics, *optics);
  }
  return snapshot;
}

Snapshot read_snapshot(const std::filesystem::path& folder, const Scan& scan, const Shot& shot) {
  const Intrinsics& intrinsics = scan.intrinsics;
  if (scan.laser) {
    throw Error(ErrorCode::scan_malformed, "a scan by laser line has no depth images");
  }
  const std::string png = read_scan_file(folder / shot.file);
  DepthFrame frame = decode_depth_png(shot.file, std::as_bytes(std::span(png)), intrinsics.width,
                                      intrinsics.height);
  return make_snapshot(std::move(frame), scan, shot);
}

void write_scan(const std::filesystem::path& folder, const Scan& scan) {
  json shots = json::array();
  for (const Shot& shot : scan.shots) {
    shots.push_back(shot_json(shot, scan.laser));
  }
  json document{
      {"format", "octurn-scan"},
      {"version", is_one_turn(scan) && !scan.laser ? 1 : 2},
      {"sensor", to_json(SensorJson{.name = scan.sensor_name,
                                    .serial = scan.sensor_serial,
                                    .intrinsics = scan.intrinsics,
                                    .laser = scan.laser,
                                    .optics = scan.optics,
                                    .scale_sigma = scan.scale_sigma,
                                    .on_for = scan.sensor_on_for})},
      {"snapshots", shots},
  };
  if (!has_free_poses(scan)) {
    document["calibration"] =
        to_json(RigPose{.platform_from_sensor = scan.platform_from_sensor, .solved = scan.solved});
  }
  if (scan.clip.min != everywhere.min || scan.clip.max != everywhere.max) {
    document["clip_m"] = to_json(scan.clip);
  }
  if (!scan.poses.empty()) {
    document["poses"] = to_json(scan.poses);
  }
  write_document(folder, document);
}

namespace {

/// The document of a scan. @throws Error  as `read_scan`
json scan_document(const std::filesystem::path& folder) {
  const std::string text = read_scan_file(folder / "scan.json");
  parse_scan(text);  // refuses a file that is not a scan
  return parse_json(text, ErrorCode::scan_malformed, "scan.json");
}

}  // namespace

void write_solved_pose(const std::filesystem::path& folder, const SolvedPose& solved,
                       std::span<const double> slipped) {
  json document = scan_document(folder);
  document["calibration"]["solved"] = to_json(solved);
  json& shots = document["snapshots"];
  for (std::size_t i = 0; i < shots.size(); ++i) {
    if (const double angle = i < slipped.size() ? slipped[i] : 0; angle != 0) {
      shots[i]["slipped_deg"] = degrees_from_radians(angle);
    } else {
      shots[i].erase("slipped_deg");
    }
  }
  write_document(folder, document);
}

void write_clip(const std::filesystem::path& folder, const Box& clip) {
  json document = scan_document(folder);
  document["clip_m"] = to_json(clip);
  write_document(folder, document);
}

std::string shot_file(int index) {
  std::string number = std::to_string(index);
  number.insert(0, number.size() < 3 ? 3 - number.size() : 0, '0');
  return "snapshots/" + number + ".png";
}

}  // namespace octurn
