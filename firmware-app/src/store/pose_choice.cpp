#include "store/pose_choice.hpp"

#include <nlohmann/json.hpp>
#include <utility>
#include <vector>

#include "octurn/json_object.hpp"
#include "octurn/units.hpp"

namespace octurn {
namespace {

constexpr double max_point_mm = 1000;

Eigen::Vector3d point_from(const JsonValue& value) {
  Eigen::Vector3d point;
  Eigen::Index axis = 0;
  for (const JsonValue& coordinate : value.elements(3)) {
    point[axis++] = metres_from_mm(coordinate.number(-max_point_mm, max_point_mm));
  }
  return point;
}

Eigen::Isometry3d pose_from(const JsonValue& value) {
  std::vector<PointPair> pairs;
  for (const JsonValue& pair : value.elements()) {
    const std::vector<JsonValue> points = pair.elements(2);
    pairs.push_back({.object = point_from(points[0]), .platform = point_from(points[1])});
  }
  const auto pose = pose_from_pairs(pairs);
  if (!pose) {
    value.refuse("at least three pairs of points that do not lie on a line");
  }
  return *pose;
}

}  // namespace

PoseChoice pose_choice_from(const nlohmann::json& body, const Job& pose) {
  JsonObject keys(body, ErrorCode::bad_settings, "");
  const auto candidate = keys.value("candidate");
  const auto pairs = keys.value("pairs_mm");
  keys.refuse_unread();
  if (candidate.has_value() == pairs.has_value()) {
    throw Error(ErrorCode::bad_settings, "neither a candidate nor pairs of points, or both",
                "Give \"candidate\" or \"pairs_mm\".");
  }
  if (pairs) {
    return {.pose = pose.id, .object_from_platform = pose_from(*pairs)};
  }
  const auto& registration = pose.pose_of->registration;
  const auto count = registration ? static_cast<int>(registration->candidates.size()) : 0;
  if (count == 0) {
    throw Error(ErrorCode::bad_settings, "no candidates of this pose are known",
                "Give \"pairs_mm\", or scan it again.");
  }
  const auto which = static_cast<std::size_t>(candidate->whole_number(0, count - 1));
  return {.pose = pose.id,
          .object_from_platform = registration->candidates[which].object_from_platform,
          .candidate = which};
}

}  // namespace octurn
