#include "settings/pose_field.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <nlohmann/json.hpp>
#include <optional>

#include "octurn/snapshot.hpp"

namespace octurn {

Access pose(Eigen::Isometry3d& value) {
  const nlohmann::json row{{"type", "array"}, {"items", {{"type", "number"}}}};
  return {.read = [&value](const JsonValue& given) { value = to_pose(given); },
          .write = [&value] { return to_rows(value); },
          .schema = {{"type", "array"}, {"items", row}}};
}

namespace {

using nlohmann::json;

constexpr double max_coordinate = 10;  // metres; no depth sensor of this kind sees farther

/// @return nullopt unless these are four rows of four numbers in range
std::optional<Eigen::Matrix4d> matrix_from(const json& rows) {
  const auto in_range = [](const json& value) {
    return value.is_number() && std::abs(value.get<double>()) <= max_coordinate;
  };
  if (!rows.is_array() || rows.size() != 4) {
    return std::nullopt;
  }
  Eigen::Matrix4d matrix;
  for (std::size_t row = 0; row < 4; ++row) {
    if (!rows[row].is_array() || rows[row].size() != 4 ||
        !std::ranges::all_of(rows[row], in_range)) {
      return std::nullopt;
    }
    for (std::size_t column = 0; column < 4; ++column) {
      matrix(static_cast<Eigen::Index>(row), static_cast<Eigen::Index>(column)) =
          rows[row][column].get<double>();
    }
  }
  return matrix;
}

}  // namespace

json to_rows(const Eigen::Isometry3d& pose) {
  json rows = json::array();
  for (int row = 0; row < 4; ++row) {
    rows.push_back({pose(row, 0), pose(row, 1), pose(row, 2), pose(row, 3)});
  }
  return rows;
}

Eigen::Isometry3d to_pose(const JsonValue& rows) {
  const auto matrix = matrix_from(rows.json());
  if (!matrix || !is_rigid(*matrix)) {
    rows.refuse(
        "four rows of four numbers, a rotation and a translation in metres, the last row 0 0 0 1");
  }
  return Eigen::Isometry3d(*matrix);
}

}  // namespace octurn
