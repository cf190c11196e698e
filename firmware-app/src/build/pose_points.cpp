#include "build/pose_points.hpp"

#include <cmath>
#include <nlohmann/json.hpp>

#include "octurn/file.hpp"
#include "octurn/units.hpp"

namespace octurn {
namespace {

using nlohmann::json;

void append(json& list, const std::vector<Eigen::Vector3f>& points, const Eigen::Isometry3d& pose) {
  const auto tenths = [](double metres) { return std::round(10 * mm_from_metres(metres)) / 10; };
  for (const Eigen::Vector3f& point : points) {
    const Eigen::Vector3d at = pose * point.cast<double>();
    list.push_back({tenths(at.x()), tenths(at.y()), tenths(at.z())});
  }
}

}  // namespace

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
