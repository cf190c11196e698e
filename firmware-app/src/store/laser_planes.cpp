#include "store/laser_planes.hpp"

#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <utility>

#include "settings/laser_settings.hpp"

namespace octurn {
namespace {

constexpr double stored_normal_tolerance = 1e-4;  // rounding of decimals in a file

}  // namespace

nlohmann::json planes_to_json(const std::vector<Laser>& lasers) {
  nlohmann::json list = nlohmann::json::array();
  for (const Laser& laser : lasers) {
    const Eigen::Vector3d& n = laser.normal;
    list.push_back({{"name", laser.name}, {"plane_m", {n.x(), n.y(), n.z(), laser.distance}}});
  }
  return list;
}

std::vector<Laser> to_planes(const JsonValue& list) {
  std::vector<Laser> lasers;
  for (const JsonValue& value : list.elements()) {
    JsonObject keys(value);
    const JsonValue plane = keys.at("plane_m");
    const std::vector<JsonValue> numbers = plane.elements(4);
    const auto number = [&](std::size_t i) {
      return numbers[i].number(-max_laser_coordinate, max_laser_coordinate);
    };
    Laser laser{.name = keys.at("name").text(), .normal = {number(0), number(1), number(2)}};
    laser.distance = number(3);
    if (std::abs(laser.normal.norm() - 1) > stored_normal_tolerance) {
      plane.refuse("a plane nx, ny, nz, d with a normal of length 1");
    }
    lasers.push_back(std::move(laser));
  }
  return lasers;
}

}  // namespace octurn
