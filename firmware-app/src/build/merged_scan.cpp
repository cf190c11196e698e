#include "build/merged_scan.hpp"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <string>
#include <system_error>
#include <utility>

#include "octurn/error.hpp"
#include "octurn/file.hpp"
#include "octurn/units.hpp"
#include "settings/scan_settings.hpp"
#include "store/stored_scan.hpp"

namespace octurn {
namespace {

bool any(std::uint16_t depth) { return depth != 0; }

auto find_row(const DepthFrame& frame, int v) {
  return frame.depth.begin() + static_cast<std::ptrdiff_t>(v) * frame.width;
}

using nlohmann::json;

void append(json& list, const std::vector<Eigen::Vector3f>& points, const Eigen::Isometry3d& pose) {
  const auto tenths = [](double metres) { return std::round(10 * mm_from_metres(metres)) / 10; };
  for (const Eigen::Vector3f& point : points) {
    const Eigen::Vector3d at = pose * point.cast<double>();
    list.push_back({tenths(at.x()), tenths(at.y()), tenths(at.z())});
  }
}

}  // namespace

KeptFrames::KeptFrames(std::size_t count, std::size_t max_bytes)
    : windows_(count), room_(max_bytes) {}

void KeptFrames::keep(std::size_t index, const DepthFrame& frame) {
  int left = frame.width;
  int right = 0;
  int top = frame.height;
  int bottom = 0;
  for (int v = 0; v < frame.height; ++v) {
    const auto begin = find_row(frame, v);
    const auto end = begin + frame.width;
    const auto first = std::find_if(begin, end, any);
    if (first != end) {
      const auto last = std::find_if(std::reverse_iterator(end), std::reverse_iterator(begin), any);
      left = std::min(left, static_cast<int>(first - begin));
      right = std::max(right, static_cast<int>(last.base() - begin));
      top = std::min(top, v);
      bottom = v + 1;
    }
  }
  Window window{.width = frame.width, .height = frame.height};
  if (bottom > 0) {
    window.left = left;
    window.top = top;
    window.columns = right - left;
  }
  const std::size_t bytes = sizeof(std::uint16_t) * static_cast<std::size_t>(window.columns) *
                            static_cast<std::size_t>(std::max(bottom - window.top, 0));
  std::size_t room = room_;
  do {
    if (room < bytes) {
      return;
    }
  } while (!room_.compare_exchange_weak(room, room - bytes));
  window.depth.reserve(bytes / sizeof(std::uint16_t));
  for (int v = window.top; v < bottom; ++v) {
    const auto from = find_row(frame, v) + window.left;
    window.depth.insert(window.depth.end(), from, from + window.columns);
  }
  windows_[index] = std::move(window);
}

std::optional<DepthFrame> KeptFrames::find(std::size_t index) const {
  const auto& window = windows_[index];
  if (!window) {
    return std::nullopt;
  }
  DepthFrame frame{.width = window->width, .height = window->height, .depth = {}};
  frame.depth.resize(static_cast<std::size_t>(frame.width) *
                     static_cast<std::size_t>(frame.height));
  auto to =
      frame.depth.begin() + static_cast<std::ptrdiff_t>(window->top) * frame.width + window->left;
  for (auto from = window->depth.begin(); from != window->depth.end();
       from += window->columns, to += frame.width) {
    std::copy_n(from, window->columns, to);
  }
  return frame;
}

namespace {

namespace fs = std::filesystem;

// Metres, around a turn's points in its clip box: without shrinking, boxes that are rotated against
// each other span much empty space, which costs more than the object.
constexpr double clip_margin = 0.020;
constexpr double min_height = 0.004;  // metres: lower readings may be the platform's

/// Extracts one pose of a scan, as a scan of one turn.
Scan to_turn(const Scan& scan, int number) {
  const ScanPose& pose = scan.poses[static_cast<std::size_t>(number)];
  Scan turn = scan;
  turn.poses.clear();
  turn.shots.clear();
  turn.platform_from_sensor = pose.platform_from_sensor;
  turn.solved = pose.solved;
  turn.clip = pose.clip;
  for (Shot shot : scan.shots) {
    if (shot.pose == number) {
      shot.pose = 0;
      turn.shots.push_back(std::move(shot));
    }
  }
  return turn;
}

/// Whether two scans are of one sensor, each with any known length: it changes the depth unit.
bool can_be_merged(const Scan& one, Scan other) {
  const double ratio = other.intrinsics.depth_unit / one.intrinsics.depth_unit;
  if (ratio > min_depth_scale / max_depth_scale && ratio < max_depth_scale / min_depth_scale) {
    other.intrinsics.depth_unit = one.intrinsics.depth_unit;
  }
  return have_same_sensor(one, other);
}

void append_turns(std::vector<StoredTurn>& turns, const fs::path& folder) {
  const Scan scan = read_scan(folder);
  const auto refuse = [&](const std::string& what, const std::string& hint) {
    throw Error(ErrorCode::scan_malformed, folder.string() + ": " + what, hint);
  };
  if (!turns.empty() && !can_be_merged(turns.front().scan, scan)) {
    refuse("is of another sensor than " + turns.front().folder.string(),
           "Merge scans of one sensor.");
  }
  if (is_one_turn(scan)) {
    turns.push_back({.folder = folder, .scan = scan, .object_from_platform = {}});
    return;
  }
  if (scan.poses.empty()) {
    refuse("is no turn of the platform: its snapshots have poses of their own",
           "Merge scans of the turntable.");
  }
  const bool is_first = turns.empty();
  for (std::size_t i = 0; i < scan.poses.size(); ++i) {
    StoredTurn turn{.folder = folder, .scan = to_turn(scan, static_cast<int>(i))};
    if (!is_one_turn(turn.scan) || turn.scan.shots.empty()) {
      refuse("pose " + std::to_string(i) + " is no turn of the platform",
             "Merge scans of the turntable.");
    }
    if (is_first) {
      turn.object_from_platform = scan.poses[i].object_from_platform;
    }
    turns.push_back(std::move(turn));
  }
}

/// Makes a hard link to a file; copies it where that fails.
void link_or_copy(const fs::path& from, const fs::path& to) {
  std::error_code error;
  fs::create_hard_link(fs::canonical(from), to, error);
  if (error) {
    fs::copy_file(from, to);
  }
}

/// Bounding box of one stop's object points in a turn's clip box: metres, platform frame at angle
/// 0. Every other row and column is enough.
Eigen::AlignedBox3d make_extent(const DepthFrame& frame, const Intrinsics& lens,
                                const Eigen::Isometry3d& pose, const Box& clip) {
  Eigen::AlignedBox3d extent;
  for (int v = 0; v < frame.height; v += 2) {
    const auto row = frame.depth.begin() + static_cast<std::ptrdiff_t>(v) * frame.width;
    for (int u = 0; u < frame.width; u += 2) {
      if (row[u] > 0) {
        const Eigen::Vector3d ray((u - lens.cx) / lens.fx, (v - lens.cy) / lens.fy, 1);
        const Eigen::Vector3d point = pose * (ray * (row[u] * lens.depth_unit));
        if (point.z() > min_height && contains(clip, point)) {
          extent.extend(point);
        }
      }
    }
  }
  return extent;
}

/// Shrinks the sides and the top of a turn's clip box to the points in it, plus a margin.
Box shrunk_clip(const StoredTurn& turn) {
  const Box& clip = turn.scan.clip;
  Eigen::AlignedBox3d extent;
  for (const auto& of_stop : turn.extents) {
    extent.extend(of_stop);
  }
  if (extent.isEmpty()) {
    return clip;
  }
  const Eigen::Vector3d margin = Eigen::Vector3d::Constant(clip_margin);
  Box box{.min = clip.min.cwiseMax(extent.min() - margin),
          .max = clip.max.cwiseMin(extent.max() + margin)};
  box.min.z() = clip.min.z();
  return box;
}

/// Links a stop's images into a folder, as the stop of index `number`.
Shot link_shot(const Shot& shot, const StoredTurn& turn, const fs::path& folder, int number) {
  Shot there = shot;
  if (turn.scan.laser) {
    there.pictures = picture_files(number, *turn.scan.laser);
    for (std::size_t i = 0; i < shot.pictures.size(); ++i) {
      link_or_copy(turn.folder / shot.pictures[i], folder / there.pictures[i]);
    }
  } else {
    there.file = shot_file(number);
    link_or_copy(turn.folder / shot.file, folder / there.file);
  }
  return there;
}

/// The optics of a turn's models, relative to the merged scan's depth unit: a known length is in
/// the unit where the optics were not known, and in their scale where they were.
SolvedOptics optics_in(const Scan& merged, const Scan& turn) {
  const Intrinsics& lens = turn.intrinsics;
  const SolvedOptics own{.value = {.fx = lens.fx, .fy = lens.fy, .cx = lens.cx, .cy = lens.cy},
                         .sigma = {.fx = 0, .fy = 0, .cx = 0, .cy = 0, .depth_scale = 0}};
  SolvedOptics optics =
      turn.solved && turn.solved->optics ? *turn.solved->optics : turn.optics.value_or(own);
  optics.value.depth_scale *= lens.depth_unit / merged.intrinsics.depth_unit;
  return optics;
}

bool have_same_optics(const Scan& a, const Scan& b) {
  return a.optics && b.optics ? a.optics->value == b.optics->value
                              : a.optics.has_value() == b.optics.has_value();
}

/// Returns the solved pose of a depth sensor's turn. Optics that differ from the merged scan's
/// count as solved, too: a scan has one set.
std::optional<SolvedPose> solved_depth_in(const Scan& merged, const Scan& turn) {
  const bool has_solved_optics = turn.solved && turn.solved->optics;
  const bool has_same_unit = turn.intrinsics.depth_unit == merged.intrinsics.depth_unit;
  if (has_same_unit && (has_solved_optics || have_same_optics(turn, merged))) {
    return turn.solved;
  }
  SolvedPose solved =
      turn.solved.value_or(SolvedPose{.platform_from_sensor = turn.platform_from_sensor});
  solved.optics = optics_in(merged, turn);
  return solved;
}

/// Returns a turn's solved pose. Planes that differ from the merged scan's count as solved, too: a
/// scan has one set of configured planes.
std::optional<SolvedPose> solved_in(const Scan& merged, const Scan& turn) {
  if (!turn.laser) {
    return solved_depth_in(merged, turn);
  }
  const auto same_plane = [](const Laser& a, const Laser& b) {
    return a.normal == b.normal && a.distance == b.distance;
  };
  if (turn.solved || std::ranges::equal(turn.laser->lasers, merged.laser->lasers, same_plane)) {
    return turn.solved;
  }
  return SolvedPose{.platform_from_sensor = turn.platform_from_sensor,
                    .lasers = turn.laser->lasers};
}

/// Links the snapshots of all turns into a folder. @return the merged scan
Scan gather(const fs::path& folder, const std::vector<StoredTurn>& turns,
            const Registration& registration) {
  Scan merged = turns.front().scan;
  merged.shots.clear();
  fs::create_directories(folder / "snapshots");
  if (merged.sensor_map) {
    link_or_copy(turns.front().folder / sensor_map_file, folder / sensor_map_file);
  }
  for (std::size_t i = 0; i < turns.size(); ++i) {
    const Scan& scan = turns[i].scan;
    merged.scale_sigma = std::max(merged.scale_sigma, scan.scale_sigma);
    merged.sensor_on_for = std::min(merged.sensor_on_for, scan.sensor_on_for);  // nullopt: unknown
    merged.poses.push_back({.object_from_platform = registration.poses[i].object_from_platform,
                            .platform_from_sensor = scan.platform_from_sensor,
                            .solved = solved_in(merged, scan),
                            .clip = shrunk_clip(turns[i])});
    for (const Shot& shot : scan.shots) {
      merged.shots.push_back(
          link_shot(shot, turns[i], folder, static_cast<int>(merged.shots.size())));
      merged.shots.back().pose = static_cast<int>(i);
    }
  }
  return merged;
}

/// Makes the registration input of a depth sensor's turn.
RegistrationTurn depth_turn(const StoredTurn& turn, const std::stop_token& stop) {
  RegistrationTurn one{.intrinsics = model_intrinsics(turn.scan, turn.scan.shots.front()),
                       .platform_from_sensor = model_pose(turn.scan),
                       .clip = turn.scan.clip};
  for (const Shot& shot : turn.scan.shots) {
    one.angles.push_back(shot.angle + shot.slipped);
  }
  one.read = [&turn, stored = stored_snapshots(turn.folder, turn.scan, stop)](std::size_t i) {
    auto kept = turn.kept ? turn.kept->find(i) : std::nullopt;
    return kept ? *std::move(kept) : stored.read(i).frame;
  };
  return one;
}

}  // namespace

std::vector<StoredTurn> read_turns(const std::vector<fs::path>& folders) {
  std::vector<StoredTurn> turns;
  for (const fs::path& folder : folders) {
    append_turns(turns, folder);
  }
  return turns;
}

Registration register_turns(std::vector<StoredTurn>& turns, int threads,
                            const std::stop_token& stop) {
  solve_rigs(turns, threads, stop);
  std::vector<RegistrationTurn> seen;
  for (StoredTurn& turn : turns) {
    RegistrationTurn one =
        turn.scan.laser ? laser_turn(turn.folder, turn.scan, stop) : depth_turn(turn, stop);
    one.object_from_platform = turn.object_from_platform;
    one.prior_object_from_platform = turn.prior_object_from_platform;
    turn.extents.assign(one.angles.size(), {});
    one.read = [&turn, lens = one.intrinsics, angles = one.angles,
                read = std::move(one.read)](std::size_t i) {
      DepthFrame frame = read(i);
      turn.extents[i] = make_extent(
          frame, lens, object_from_sensor(model_pose(turn.scan), angles[i]), turn.scan.clip);
      return frame;
    };
    seen.push_back(std::move(one));
  }
  Registration registration = register_turns(seen, threads, stop);
  for (StoredTurn& turn : turns) {
    turn.kept.reset();  // the model that follows needs the memory
  }
  return registration;
}

void write_merged_scan(const fs::path& folder, const std::vector<StoredTurn>& turns,
                       const Registration& registration) {
  const fs::path target = fs::absolute(folder / "").parent_path();
  fs::path temporary;
  for (int attempt = 0; temporary.empty() || fs::exists(temporary); ++attempt) {
    temporary = temporary_name(target, attempt);
  }
  try {
    write_scan(temporary, gather(temporary, turns, registration));
    sync_folder(temporary / "snapshots");
    sync_folder(temporary);
    fs::rename(temporary, target);
    sync_folder(target.parent_path());
  } catch (const fs::filesystem_error& error) {
    std::error_code ignored;
    fs::remove_all(temporary, ignored);
    const bool is_full = error.code() == std::errc::no_space_on_device;
    throw Error(is_full ? ErrorCode::disk_full : ErrorCode::write_failed,
                target.string() + ": " + error.code().message(), {}, {{"path", target.string()}});
  } catch (...) {
    std::error_code ignored;
    fs::remove_all(temporary, ignored);
    throw;
  }
}

namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

constexpr double max_sigmas = 3;  // maximum distance of a turn from the mean

/// A rotation vector and a shift.
struct SmallMotion {
  Vector3d rotation = Vector3d::Zero();  // radians
  Vector3d shift = Vector3d::Zero();     // metres
};

SmallMotion motion_between(const Isometry3d& from, const Isometry3d& to) {
  const Isometry3d between = to * from.inverse();
  const Eigen::AngleAxisd turn(between.linear());
  return {.rotation = turn.angle() * turn.axis(), .shift = between.translation()};
}

Isometry3d moved(const Isometry3d& pose, const SmallMotion& motion) {
  const double angle = motion.rotation.norm();
  Isometry3d by = Isometry3d::Identity();
  if (angle > 0) {
    by.linear() = Eigen::AngleAxisd(angle, motion.rotation / angle).toRotationMatrix();
  }
  by.translation() = motion.shift;
  return by * pose;
}

}  // namespace

std::optional<Isometry3d> shared_pose(std::span<const SolvedPose> turns) {
  if (turns.size() < 2) {
    return std::nullopt;
  }
  const Isometry3d& first = turns.front().platform_from_sensor;
  SmallMotion mean;
  double rotation_weight = 0;
  double shift_weight = 0;
  for (const SolvedPose& turn : turns) {
    const SmallMotion motion = motion_between(first, turn.platform_from_sensor);
    const double of_rotation = 1 / (turn.direction_sigma * turn.direction_sigma);
    const double of_shift = 1 / (turn.position_sigma * turn.position_sigma);
    mean.rotation += of_rotation * motion.rotation;
    mean.shift += of_shift * motion.shift;
    rotation_weight += of_rotation;
    shift_weight += of_shift;
  }
  mean.rotation /= rotation_weight;
  mean.shift /= shift_weight;
  const Isometry3d pose = moved(first, mean);
  for (const SolvedPose& turn : turns) {
    const SmallMotion off = motion_between(pose, turn.platform_from_sensor);
    if (!(off.rotation.norm() <= max_sigmas * turn.direction_sigma &&
          off.shift.norm() <= max_sigmas * turn.position_sigma)) {
      return std::nullopt;
    }
  }
  return pose;
}

namespace {

constexpr std::size_t max_kept_bytes = 16'000'000;  // cached depth images of all turns

/// Turns with the same configured pose come from one rig if their solved poses agree. Then all get
/// the mean, which is more accurate than each. Does nothing if a turn is registered already, or has
/// solved optics, with which its pose belongs.
void share_rig(std::vector<StoredTurn>& turns) {
  std::vector<SolvedPose> solved;
  const Eigen::Isometry3d& configured = turns.front().scan.platform_from_sensor;
  for (const StoredTurn& turn : turns) {
    const Scan& scan = turn.scan;
    if (turn.object_from_platform || !scan.solved || scan.solved->optics ||
        scan.platform_from_sensor.matrix() != configured.matrix()) {
      return;
    }
    solved.push_back(*scan.solved);
  }
  if (const auto shared = shared_pose(solved)) {
    for (StoredTurn& turn : turns) {
      turn.scan.solved->platform_from_sensor = *shared;
    }
  }
}

/// Solves the pose of a turn's sensor, and keeps the depth images that this has read.
void solve_rig(StoredTurn& turn, std::size_t kept_bytes, int threads, const std::stop_token& stop) {
  const SnapshotSource stored = stored_snapshots(turn.folder, turn.scan, stop);
  const auto kept = std::make_shared<KeptFrames>(stored.count, kept_bytes);
  const SnapshotSource read_once{.count = stored.count, .read = [&](std::size_t index) {
                                   Snapshot snapshot = stored.read(index);
                                   kept->keep(index, snapshot.frame);
                                   return snapshot;
                                 }};
  const ScanSolution solution = solve_scan(turn.folder, turn.scan, read_once, threads, stop);
  take_solution(turn.scan, solution);
  if (!solution.report.optics_differ) {  // else other depth images follow from the same files
    turn.kept = kept;
  }
}

}  // namespace

void solve_rigs(std::vector<StoredTurn>& turns, int threads, const std::stop_token& stop) {
  if (std::ranges::all_of(turns, &StoredTurn::is_rig_solved)) {
    return;
  }
  for (StoredTurn& turn : turns) {
    if (!turn.is_rig_solved && !turn.scan.solved && !turn.object_from_platform) {
      solve_rig(turn, max_kept_bytes / turns.size(), threads, stop);
    }
    turn.is_rig_solved = true;
  }
  if (!turns.front().scan.laser) {  // planes belong to their turn's pose
    share_rig(turns);
  }
}

void write_pose_points(const std::filesystem::path& folder, const std::vector<StoredTurn>& turns,
                       const std::vector<std::vector<Eigen::Vector3f>>& points) {
  json before = json::array();
  for (std::size_t i = 0; i + 1 < turns.size(); ++i) {
    append(before, points[i],
           turns[i].object_from_platform.value_or(Eigen::Isometry3d::Identity()));
  }
  json pose = json::array();
  append(pose, points.back(), Eigen::Isometry3d::Identity());
  write_file(folder / pose_points_file,
             json{{"before_mm", std::move(before)}, {"pose_mm", std::move(pose)}}.dump());
}

}  // namespace octurn
