// Instantiates, within Clang's precompiled headers, the templates that most sources use: a source
// then need not instantiate them again, which takes a quarter of its time. GCC would instantiate
// them at the end of each source all the same.
#pragma once

#include <Eigen/Geometry>

namespace octurn_precompiled {

inline Eigen::Isometry3d transforms(const Eigen::Isometry3d& a, const Eigen::Isometry3d& b,
                                    const Eigen::Vector3d& v, double angle) {
  Eigen::Isometry3d c = Eigen::Translation3d(v) * Eigen::AngleAxisd(angle, v) * a * b.inverse();
  c.linear() << 1, 0, 0, 0, 1, 0, 0, 0, 1;
  c.translation() << 0, 1, 2;
  c.translation() =
      a * v + b.linear() * v.normalized() + v.cross(a.translation()) * v.dot(v) - v * v.norm();
  c.linear() = a.linear().transpose() * b.linear();
  const Eigen::Matrix3d turn =
      Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  c.linear() = turn * turn;
  const Eigen::Isometry3d d(Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitZ()));
  return Eigen::Isometry3d::Identity() * d * Eigen::Translation3d(v) * c;
}

inline Eigen::Vector3f floats(const Eigen::Vector3f& a, const Eigen::Vector3f& b,
                              const Eigen::Isometry3d& t) {
  Eigen::Vector3f c = (t * a.cast<double>()).cast<float>();
  c += (a - b).cross(b).normalized() * a.dot(b) + 2.0F * a;
  return c * (a - b).norm() / c.squaredNorm();
}

#ifdef INCLUDE_NLOHMANN_JSON_HPP_  // after the header of that name

inline std::string json_text(const std::string& text, std::uint64_t number) {
  nlohmann::json made{{"a", 1}, {"b", 2.0}, {"c", text}, {"d", true}};
  made["e"] = text;
  made["f"] = 1.5;
  made["g"] = number;
  made["h"] = nlohmann::json::array();
  made["i"] = false;
  made["j"] = -1;
  made["k"] = "literal";
  made["l"] = nullptr;
  made["m"] = {1.0, 2.0, 3.0};
  made.push_back(1);
  for (const auto& [key, value] : made.items()) {
    if (value.is_string()) {
      made[key] = value.get<std::string>();
    }
  }
  const nlohmann::json read = nlohmann::json::parse(text, nullptr, false);
  if (read.contains("a") &&
      read.at("b").get<double>() + read.value("c", 0.0) > read.value("d", 1) &&
      read.at("e").get<bool>()) {
    return read.value("f", std::string());
  }
  return made.dump(2) + read.dump() + std::to_string(read.at("g").get<int>()) +
         std::to_string(read.at("h").get<std::uint64_t>());
}

#endif

}  // namespace octurn_precompiled
