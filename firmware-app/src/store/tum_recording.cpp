#include "store/tum_recording.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <optional>
#include <sstream>
#include <utility>

#include "octurn/error.hpp"
#include "octurn/file.hpp"

namespace octurn {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t max_list_bytes = std::size_t{64} << 20U;
constexpr double max_gap = 0.1;            // seconds between the poses around an image
constexpr double same_time = 1e-6;         // seconds: times have six decimals
constexpr double quaternion_slack = 0.01;  // of its length from one: files have four decimals

struct TimedPose {
  double time = 0;  // seconds
  Eigen::Isometry3d world_from_camera = Eigen::Isometry3d::Identity();
};

std::optional<double> parse_number(std::string_view text) {
  double number = 0;
  const char* const end = text.data() + text.size();
  const auto read = std::from_chars(text.data(), end, number);
  if (read.ec != std::errc() || read.ptr != end || !std::isfinite(number)) {
    return std::nullopt;
  }
  return number;
}

/// Splits the lines of a list into words, without comments. Errors name the line.
class ListFile {
 public:
  ListFile(const fs::path& folder, const char* name) : name_(name) {
    auto text = read_regular_file(folder / name, max_list_bytes);
    if (!text) {
      throw Error(ErrorCode::scan_missing, (folder / name).string() + ": there is no such file",
                  "Name the folder of a recording, with a depth.txt and a groundtruth.txt.");
    }
    text_ = std::istringstream(*std::move(text));
  }

  /// Returns the words of the next line that is neither a comment nor empty; nullopt at the end.
  std::optional<std::vector<std::string>> next() {
    for (std::string line; std::getline(text_, line);) {
      ++line_;
      std::ranges::replace(line, ',', ' ');
      std::istringstream words(line);
      std::vector<std::string> found;
      for (std::string word; words >> word;) {
        found.push_back(std::move(word));
      }
      if (!found.empty() && found.front().front() != '#') {
        return found;
      }
    }
    return std::nullopt;
  }

  [[noreturn]] void refuse(const std::string& what) const {
    throw Error(ErrorCode::scan_malformed, name_ + " line " + std::to_string(line_) + ": " + what);
  }

  double number(const std::string& word) const {
    const auto number = parse_number(word);
    if (!number) {
      refuse("\"" + word + "\" is no number");
    }
    return *number;
  }

  void expect_later(double time, std::optional<double>& last) const {
    if (last && time < *last) {
      refuse("its time is before that of the line above");
    }
    last = time;
  }

 private:
  std::string name_;
  std::istringstream text_ = {};
  int line_ = 0;
};

std::vector<TimedPose> read_poses(const fs::path& folder) {
  ListFile list(folder, "groundtruth.txt");
  std::vector<TimedPose> poses;
  std::optional<double> last;
  while (const auto words = list.next()) {
    constexpr std::size_t columns = 8;
    if (words->size() != columns) {
      list.refuse("must be a time, three numbers of a position and four of a quaternion");
    }
    std::array<double, columns> n{};
    for (std::size_t i = 0; i < columns; ++i) {
      n[i] = list.number((*words)[i]);
    }
    list.expect_later(n[0], last);
    const Eigen::Quaterniond turn(n[7], n[4], n[5], n[6]);
    if (std::abs(turn.norm() - 1) > quaternion_slack) {
      list.refuse("its quaternion must be of length one");
    }
    poses.push_back(
        {.time = n[0],
         .world_from_camera = Eigen::Translation3d(n[1], n[2], n[3]) * turn.normalized()});
  }
  return poses;
}

/// Returns the pose at a time, or interpolated between the poses around it; nullopt if these are
/// too far apart.
std::optional<Eigen::Isometry3d> pose_at(const std::vector<TimedPose>& poses, double time) {
  const auto after = std::ranges::lower_bound(poses, time - same_time, {}, &TimedPose::time);
  if (after == poses.end()) {
    return std::nullopt;
  }
  if (after->time <= time + same_time) {
    return after->world_from_camera;
  }
  if (after == poses.begin()) {
    return std::nullopt;
  }
  const TimedPose& before = *std::prev(after);
  if (after->time - before.time > max_gap) {
    return std::nullopt;
  }
  const double part = (time - before.time) / (after->time - before.time);
  const Eigen::Isometry3d& a = before.world_from_camera;
  const Eigen::Isometry3d& b = after->world_from_camera;
  const Eigen::Vector3d position = a.translation() + part * (b.translation() - a.translation());
  const Eigen::Quaterniond turn =
      Eigen::Quaterniond(a.linear()).slerp(part, Eigen::Quaterniond(b.linear()));
  return Eigen::Isometry3d(Eigen::Translation3d(position) * turn.normalized());
}

bool is_inside(const fs::path& file) {
  return file.is_relative() && std::ranges::find(file, fs::path("..")) == file.end();
}

}  // namespace

TumRecording read_tum_recording(const fs::path& folder, int every) {
  const std::vector<TimedPose> poses = read_poses(folder);
  ListFile list(folder, "depth.txt");
  TumRecording recording;
  std::optional<double> last;
  for (int number = 0; const auto words = list.next(); ++number) {
    if (words->size() != 2) {
      list.refuse("must be a time and the name of a depth image");
    }
    const double time = list.number(words->front());
    list.expect_later(time, last);
    if (!is_inside(words->back())) {
      list.refuse("\"" + words->back() + "\" must be a file in the recording's folder");
    }
    if (number % every != 0) {
      continue;
    }
    if (const auto pose = pose_at(poses, time)) {
      recording.images.push_back({.time = time, .file = words->back(), .world_from_camera = *pose});
    } else {
      ++recording.without_pose;
    }
  }
  if (recording.images.empty()) {
    throw Error(ErrorCode::scan_empty,
                folder.string() + ": no depth image has a pose: of " +
                    std::to_string(recording.without_pose) + " none is within the times of " +
                    std::to_string(poses.size()) + " poses",
                "Look whether depth.txt and groundtruth.txt are of one recording.");
  }
  return recording;
}

Intrinsics tum_camera(std::string_view camera) {
  struct Named {
    std::string_view name;
    std::array<double, 4> values;
  };
  constexpr std::array cameras{Named{"freiburg1", {517.3, 516.5, 318.6, 255.3}},
                               Named{"freiburg2", {520.9, 521.0, 325.1, 249.7}},
                               Named{"freiburg3", {535.4, 539.2, 320.1, 247.6}},
                               Named{"default", {525.0, 525.0, 319.5, 239.5}}};
  std::array<double, 4> values{};
  const auto* const named = std::ranges::find(cameras, camera, &Named::name);
  if (named != cameras.end()) {
    values = named->values;
  } else {
    std::string text(camera);
    std::ranges::replace(text, ',', ' ');
    std::istringstream words(text);
    std::size_t count = 0;
    for (std::string word; words >> word; ++count) {
      const auto number = parse_number(word);
      if (!number || count >= values.size()) {
        count = 0;
        break;
      }
      values[count] = *number;
    }
    if (count != values.size() || values[0] <= 0 || values[1] <= 0) {
      throw Error(ErrorCode::bad_settings,
                  "intrinsics: \"" + std::string(camera) +
                      "\" must be freiburg1, freiburg2, freiburg3, default, or four numbers: "
                      "FX,FY,CX,CY");
    }
  }
  return {
      .fx = values[0], .fy = values[1], .cx = values[2], .cy = values[3], .depth_unit = 1.0 / 5000};
}

std::string_view to_tum_camera(const fs::path& folder) {
  const std::string name = fs::absolute(folder / "").parent_path().filename().string();
  for (const std::string_view camera : {"freiburg1", "freiburg2", "freiburg3"}) {
    if (name.find(camera) != std::string::npos) {
      return camera;
    }
  }
  return "default";
}

}  // namespace octurn
