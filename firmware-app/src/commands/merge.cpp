#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>

#include "build/merged_scan.hpp"
#include "commands/commands.hpp"
#include "octurn/error.hpp"
#include "octurn/units.hpp"
#include "settings/scan_settings.hpp"
#include "signal_stop.hpp"
#include "standard_output.hpp"
#include "store/job_json.hpp"

namespace octurn {
namespace {

using Json = nlohmann::ordered_json;

Json to_json(const RegisteredPose& pose) {
  Json matrix = Json::array();
  for (int row = 0; row < 4; ++row) {
    Json values = Json::array();
    for (int column = 0; column < 4; ++column) {
      values.push_back(pose.object_from_platform(row, column));
    }
    matrix.push_back(std::move(values));
  }
  return {{"object_from_platform", std::move(matrix)},
          {"sigma_mm", mm_from_metres(pose.position_sigma)},
          {"sigma_deg", degrees_from_radians(pose.direction_sigma)},
          {"overlap", pose.overlap},
          {"residual_mm", mm_from_metres(pose.residual)},
          {"contradiction", pose.contradiction},
          {"symmetric", pose.symmetric}};
}

Json to_json(const Registration& registration) {
  bool symmetric = false;
  Json poses = Json::array();
  for (const RegisteredPose& pose : registration.poses) {
    poses.push_back(to_json(pose));
    symmetric = symmetric || pose.symmetric;
  }
  Json candidates = Json::array();
  for (const RegistrationCandidate& candidate : registration.candidates) {
    candidates.emplace_back(octurn::to_json(candidate));
  }
  return {{"accepted", registration.accepted},
          {"reason", registration.reason},
          {"symmetric", symmetric},
          {"poses", std::move(poses)},
          {"candidates", std::move(candidates)}};
}

/// The registration as lines for people.
std::string to_text(const Registration& registration, const std::vector<StoredTurn>& turns) {
  if (!registration.accepted) {
    return "Not merged: " + registration.reason + ".\n";
  }
  std::ostringstream text;
  text.setf(std::ios::fixed);
  text.precision(2);
  for (std::size_t i = 1; i < registration.poses.size(); ++i) {
    if (turns[i].object_from_platform) {
      continue;
    }
    const RegisteredPose& pose = registration.poses[i];
    const Eigen::AngleAxisd turned(pose.object_from_platform.linear());
    text << "Pose " << i << " lies " << std::lround(degrees_from_radians(turned.angle()))
         << " degrees from the first, and shares " << std::lround(100 * pose.overlap)
         << " % of its surface, to within " << mm_from_metres(pose.residual) << " mm.\n";
    if (pose.symmetric) {
      text << "The object is symmetric: other poses give the same shape.\n";
    } else {
      text << "Known to " << mm_from_metres(pose.position_sigma) << " mm and "
           << degrees_from_radians(pose.direction_sigma) << " degrees.\n";
    }
  }
  return text.str();
}

/// Solves the last scan's pose from point correspondences, mm. @throws Error "bad-settings"
Eigen::Isometry3d pose_from(const std::vector<double>& coordinates) {
  constexpr std::size_t coordinates_of_pair = 6;
  std::vector<PointPair> pairs;
  const auto point = [&](std::size_t first) {
    return Eigen::Vector3d(metres_from_mm(coordinates[first]),
                           metres_from_mm(coordinates[first + 1]),
                           metres_from_mm(coordinates[first + 2]));
  };
  for (std::size_t i = 0; i + coordinates_of_pair <= coordinates.size(); i += coordinates_of_pair) {
    pairs.push_back({.object = point(i), .platform = point(i + 3)});
  }
  const auto pose = pose_from_pairs(pairs);
  if (coordinates.size() % coordinates_of_pair != 0 || !pose) {
    throw Error(ErrorCode::bad_settings,
                "--pairs: must be six numbers a pair, of at least three pairs of points that do "
                "not lie on a line");
  }
  return *pose;
}

/// Registers the turns. The arguments may give an estimate of the last turn's pose.
Registration register_as_told(std::vector<StoredTurn>& turns, const MergeArguments& arguments,
                              int threads, const std::stop_token& stop) {
  auto& prior = turns.back().prior_object_from_platform;
  if (!arguments.pairs.empty()) {
    prior = pose_from(arguments.pairs);
  }
  Registration registration = register_turns(turns, threads, stop);
  if (!arguments.candidate) {
    return registration;
  }
  const auto count = static_cast<int>(registration.candidates.size());
  if (*arguments.candidate < 0 || *arguments.candidate >= count) {
    throw Error(ErrorCode::bad_settings,
                "--candidate " + std::to_string(*arguments.candidate) + ": there are " +
                    std::to_string(count),
                "--json lists them; 0 is the first.");
  }
  const std::vector<RegistrationCandidate> candidates = std::move(registration.candidates);
  prior = candidates[static_cast<std::size_t>(*arguments.candidate)].object_from_platform;
  registration = register_turns(turns, threads, stop);
  registration.candidates = candidates;
  return registration;
}

void expect_absent(const std::filesystem::path& folder) {
  std::error_code error;
  if (folder.empty()) {
    throw Error(ErrorCode::bad_settings, "--output is empty: must be a folder");
  }
  if (std::filesystem::exists(folder, error) && !std::filesystem::is_empty(folder, error)) {
    throw Error(ErrorCode::write_failed, folder.string() + ": is there already",
                "Name a folder that does not exist yet.");
  }
}

}  // namespace

bool merge(const MergeArguments& arguments) try {
  const SignalStop signal;
  const int threads = available_threads();
  expect_absent(arguments.output);
  std::vector<StoredTurn> turns = read_turns(arguments.folders);
  if (turns.size() < 2) {
    throw Error(ErrorCode::bad_settings, "one turn alone: there is nothing to merge it with",
                "Name the folders of two scans of the object.");
  }
  const Registration registration = register_as_told(turns, arguments, threads, signal.token());
  if (registration.accepted) {
    write_merged_scan(arguments.output, turns, registration);
  }
  write_standard_output(arguments.json ? to_json(registration).dump() + "\n"
                                       : to_text(registration, turns));
  return registration.accepted;
} catch (const Stopped&) {
  throw_stopped("nothing was merged");
}

}  // namespace octurn
