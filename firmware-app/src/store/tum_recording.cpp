#include "store/tum_recording.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <iomanip>
#include <optional>
#include <sstream>
#include <system_error>
#include <utility>

#include "octurn/error.hpp"
#include "octurn/file.hpp"

namespace octurn {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t max_list_bytes = std::size_t{64} << 20U;
constexpr double same_time = 1e-6;         // seconds: times have six decimals
constexpr double quaternion_slack = 0.01;  // of its length from one: files have four decimals

struct TimedPose {
  double time = 0;                                          // seconds
  std::optional<Eigen::Isometry3d> world_from_camera = {};  // nothing: the tracker was lost
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
  explicit ListFile(const fs::path& file) : name_(file.filename().string()) {
    auto text = read_regular_file(file, max_list_bytes);
    if (!text) {
      throw Error(ErrorCode::scan_missing, file.string() + ": there is no such file",
                  "Name the folder of a recording, with a depth.txt and a groundtruth.txt.");
    }
    constexpr std::string_view byte_order_mark = "\xEF\xBB\xBF";
    text_ =
        std::istringstream(text->starts_with(byte_order_mark) ? text->substr(byte_order_mark.size())
                                                              : *std::move(text));
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

  /// A time in seconds; its size tells its unit.
  double time(const std::string& word) const {
    constexpr double far_future = 1e11;  // in seconds since 1970; less than today in milliseconds
    double time = number(word);
    for (int i = 0; i < 3 && time > far_future; ++i) {
      time /= 1000;
    }
    return time;
  }

 private:
  std::string name_;
  std::istringstream text_ = {};
  int line_ = 0;
};

/// Returns the list of poses: groundtruth.txt, or the first *.gt.freiburg.
fs::path poses_file(const fs::path& folder) {
  const fs::path usual = folder / "groundtruth.txt";
  std::error_code error;
  fs::path found;
  if (!fs::exists(usual, error)) {
    for (const auto& entry : fs::directory_iterator(folder, error)) {
      const bool is_list = entry.path().filename().string().ends_with(".gt.freiburg");
      found = is_list && (found.empty() || entry.path() < found) ? entry.path() : found;
    }
  }
  return found.empty() ? usual : found;
}

std::optional<Eigen::Isometry3d> parse_pose(const ListFile& list,
                                            const std::vector<std::string>& words) {
  std::array<double, 7> n{};
  for (std::size_t i = 0; i < n.size(); ++i) {
    const std::string& word = words[i + 1];
    if (word.find("nan") != word.npos || word.find("NaN") != word.npos) {
      return std::nullopt;
    }
    n[i] = list.number(word);
  }
  const Eigen::Quaterniond turn(n[6], n[3], n[4], n[5]);
  if (turn.norm() == 0) {
    return std::nullopt;
  }
  if (std::abs(turn.norm() - 1) > quaternion_slack) {
    list.refuse("its quaternion must be of length one");
  }
  return Eigen::Isometry3d(Eigen::Translation3d(n[0], n[1], n[2]) * turn.normalized());
}

std::vector<TimedPose> read_poses(const fs::path& folder) {
  ListFile list(poses_file(folder));
  std::vector<TimedPose> poses;
  while (const auto words = list.next()) {
    constexpr std::size_t columns = 8;  // some programs add others
    if (words->size() < columns) {
      list.refuse("must be a time, three numbers of a position and four of a quaternion");
    }
    poses.push_back(
        {.time = list.time(words->front()), .world_from_camera = parse_pose(list, *words)});
  }
  std::ranges::stable_sort(poses, {}, &TimedPose::time);
  return poses;
}

struct FoundPose {
  std::optional<Eigen::Isometry3d> world_from_camera = {};
  double gap = 0;  // seconds between the poses around the time, if they are too far apart
};

/// Returns the pose at a time, or interpolated between the poses around it.
FoundPose pose_at(const std::vector<TimedPose>& poses, double time, double max_gap) {
  const auto after = std::ranges::lower_bound(poses, time - same_time, {}, &TimedPose::time);
  if (after == poses.end()) {
    return {};
  }
  if (after->time <= time + same_time) {
    return {.world_from_camera = after->world_from_camera};
  }
  if (after == poses.begin()) {
    return {};
  }
  const TimedPose& before = *std::prev(after);
  const double gap = after->time - before.time;
  if (gap > max_gap) {
    return {.gap = gap};
  }
  if (!before.world_from_camera || !after->world_from_camera) {
    return {};
  }
  const double part = (time - before.time) / gap;
  const Eigen::Isometry3d& a = *before.world_from_camera;
  const Eigen::Isometry3d& b = *after->world_from_camera;
  const Eigen::Vector3d position = a.translation() + part * (b.translation() - a.translation());
  const Eigen::Quaterniond turn =
      Eigen::Quaterniond(a.linear()).slerp(part, Eigen::Quaterniond(b.linear()));
  return {.world_from_camera =
              Eigen::Isometry3d(Eigen::Translation3d(position) * turn.normalized())};
}

/// A range of times for people, such as "12.5 to 14 s".
std::string range_text(double first, double last) {
  std::ostringstream text;
  text << std::fixed << std::setprecision(3) << first << " to " << last << " s";
  return text.str();
}

bool is_inside(const fs::path& file) {
  return file.is_relative() && std::ranges::find(file, fs::path("..")) == file.end();
}

/// An entry of the list of depth images, which may also list colour images.
struct ListedImage {
  double time = 0;  // seconds
  std::string file = {};
};

std::vector<ListedImage> read_images(const fs::path& folder) {
  std::error_code error;
  const bool has_depth_list =
      fs::exists(folder / "depth.txt", error) || !fs::exists(folder / "associations.txt", error);
  ListFile list(folder / (has_depth_list ? "depth.txt" : "associations.txt"));
  std::vector<ListedImage> images;
  while (auto words = list.next()) {
    const auto is_depth = [&](std::size_t column) {
      return (*words)[column].find("depth") != std::string::npos;
    };
    const bool is_second = words->size() == 4 && !is_depth(1) && is_depth(3);
    if (words->size() != 2 && (has_depth_list || words->size() != 4)) {
      list.refuse("must be a time and the name of a depth image");
    }
    std::string& file = (*words)[is_second ? 3 : 1];
    std::ranges::replace(file, '\\', '/');
    if (!is_inside(file)) {
      list.refuse("\"" + file + "\" must be a file in the recording's folder");
    }
    images.push_back({.time = list.time((*words)[is_second ? 2 : 0]), .file = std::move(file)});
  }
  return images;
}

}  // namespace

TumRecording read_tum_recording(const fs::path& folder, int every, double max_gap) {
  const std::vector<ListedImage> listed = read_images(folder);
  const std::vector<TimedPose> poses = read_poses(folder);
  TumRecording recording;
  double gap = 0;
  for (std::size_t i = 0; i < listed.size(); i += static_cast<std::size_t>(every)) {
    const FoundPose found = pose_at(poses, listed[i].time, max_gap);
    if (found.world_from_camera) {
      recording.images.push_back({.time = listed[i].time,
                                  .file = listed[i].file,
                                  .world_from_camera = *found.world_from_camera});
    } else {
      ++recording.without_pose;
      gap = std::max(gap, found.gap);
    }
  }
  if (!recording.images.empty()) {
    return recording;
  }
  std::string detail = folder.string() + ": none of " + std::to_string(recording.without_pose) +
                       " depth images has a pose";
  std::string hint = "Look whether both lists are of one recording.";
  if (gap > 0) {
    std::ostringstream seconds;
    seconds << gap;
    detail += ": the poses around them are up to " + seconds.str() + " s apart";
    hint = "Raise --max-gap-s, if the camera moved evenly in between.";
  } else if (!listed.empty() && !poses.empty()) {
    const auto [first, last] = std::ranges::minmax(listed, {}, &ListedImage::time);
    detail += ": they were taken at " + range_text(first.time, last.time) + ", the poses are of " +
              range_text(poses.front().time, poses.back().time);
  }
  throw Error(ErrorCode::scan_empty, detail, hint);
}

Intrinsics tum_camera(std::string_view camera) {
  struct Named {
    std::string_view name;
    std::array<double, 4> values;
  };
  constexpr std::array cameras{Named{"icl-nuim", {481.2, -480.0, 319.5, 239.5}},
                               Named{"freiburg1", {517.3, 516.5, 318.6, 255.3}},
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
    if (count != values.size() || values[0] <= 0 || values[1] == 0) {
      throw Error(
          ErrorCode::bad_settings,
          "intrinsics: \"" + std::string(camera) +
              "\" must be freiburg1, freiburg2, freiburg3, icl-nuim, default, or four numbers: "
              "FX,FY,CX,CY");
    }
  }
  return {
      .fx = values[0], .fy = values[1], .cx = values[2], .cy = values[3], .depth_unit = 1.0 / 5000};
}

Eigen::Isometry3d with_y_down(const Eigen::Isometry3d& world_from_camera) {
  const Eigen::Vector4d mirror(1, -1, 1, 1);
  Eigen::Isometry3d mirrored;
  mirrored.matrix() = mirror.asDiagonal() * world_from_camera.matrix() * mirror.asDiagonal();
  return mirrored;
}

std::string_view to_tum_camera(const fs::path& folder) {
  const std::string name = fs::absolute(folder / "").parent_path().filename().string();
  for (const std::string_view camera : {"freiburg1", "freiburg2", "freiburg3"}) {
    if (name.find(camera) != std::string::npos) {
      return camera;
    }
  }
  if (poses_file(folder).extension() == ".freiburg") {
    return "icl-nuim";
  }
  return "default";
}

}  // namespace octurn
