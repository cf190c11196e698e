// model_error Scan.stl: compares a model with the object that stood before the twin's Kinect.
// Prints one line of JSON: the distance of the model's corners from the object's surface (mean,
// root mean square, median, 95th percentile, largest; mm), and the share of that surface, where it
// is more than 5 mm above the platform, that is farther than 5 mm from every corner.

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <fstream>
#include <iostream>
#include <iterator>
#include <map>
#include <string>
#include <vector>

#include "octurn/units.hpp"
#include "simulator/mesh.hpp"
#include "simulator/simulator_object.hpp"

namespace octurn {
namespace {

using Eigen::Vector3d;

constexpr double far_off = 0.005;  // metres

/// The corners of a binary STL file's triangles, metres.
std::vector<Vector3d> corners_of(const std::string& file) {
  constexpr std::size_t header_bytes = 84;
  constexpr std::size_t triangle_bytes = 50;
  std::ifstream stream(file, std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(stream), {}};
  std::vector<Vector3d> corners;
  for (std::size_t at = header_bytes; at + triangle_bytes <= bytes.size(); at += triangle_bytes) {
    std::array<float, 9> numbers = {};
    std::memcpy(numbers.data(), &bytes[at + 12], sizeof numbers);  // after the normal
    for (std::size_t i = 0; i < 9; i += 3) {
      const Eigen::Vector3f corner(numbers[i], numbers[i + 1], numbers[i + 2]);
      corners.push_back(corner.cast<double>().unaryExpr(&metres_from_mm));
    }
  }
  return corners;
}

/// The first-order distance, metres: the distance field over its gradient's norm (Taubin 1991),
/// which is less than 1 where solids are blended.
double distance_to_object(const Vector3d& point) {
  constexpr double h = 1e-5;
  Vector3d slope;
  for (int axis = 0; axis < 3; ++axis) {
    const Vector3d step = h * Vector3d::Unit(axis);
    slope[axis] =
        (simulator_object_distance(point + step) - simulator_object_distance(point - step)) /
        (2 * h);
  }
  return std::abs(simulator_object_distance(point)) / std::max(slope.norm(), 0.1);
}

/// Points in a grid of cells of side `far_off`, so that near points are in neighbouring cells.
class NearPoints {
 public:
  explicit NearPoints(const std::vector<Vector3d>& points) {
    for (const Vector3d& point : points) {
      cubes_[cube_of(point)].push_back(point);
    }
  }

  bool has_near(const Vector3d& point) const {
    const Cube middle = cube_of(point);
    for (int i = 0; i < 27; ++i) {
      const auto cube =
          cubes_.find({middle[0] + i % 3 - 1, middle[1] + i / 3 % 3 - 1, middle[2] + i / 9 - 1});
      if (cube != cubes_.end() && std::ranges::any_of(cube->second, [&](const Vector3d& other) {
            return (other - point).norm() < far_off;
          })) {
        return true;
      }
    }
    return false;
  }

 private:
  using Cube = std::array<int, 3>;

  static Cube cube_of(const Vector3d& point) {
    const Vector3d cube = (point / far_off).array().floor();
    return {static_cast<int>(cube.x()), static_cast<int>(cube.y()), static_cast<int>(cube.z())};
  }

  std::map<Cube, std::vector<Vector3d>> cubes_;
};

double missing_share(const std::vector<Vector3d>& corners) {
  const NearPoints near(corners);
  int count = 0;
  int missing = 0;
  for (const Eigen::Vector3f& vertex : simulator_object().vertices) {
    const Vector3d point = vertex.cast<double>();
    if (point.z() > far_off) {
      ++count;
      missing += near.has_near(point) ? 0 : 1;
    }
  }
  return static_cast<double>(missing) / count;
}

void print_error(const std::vector<Vector3d>& corners) {
  std::vector<double> distances;
  double sum = 0;
  double squares = 0;
  for (const Vector3d& corner : corners) {
    distances.push_back(mm_from_metres(distance_to_object(corner)));
    sum += distances.back();
    squares += distances.back() * distances.back();
  }
  std::ranges::sort(distances);
  const auto count = static_cast<double>(distances.size());
  std::cout << R"({"mean_mm": )" << sum / count << R"(, "rms_mm": )" << std::sqrt(squares / count)
            << R"(, "median_mm": )" << distances[distances.size() / 2] << R"(, "p95_mm": )"
            << distances[distances.size() * 95 / 100] << R"(, "max_mm": )" << distances.back()
            << R"(, "missing": )" << missing_share(corners) << "}" << std::endl;
}

}  // namespace
}  // namespace octurn

int main(int argc, char** argv) {
  const std::vector<Eigen::Vector3d> corners =
      argc == 2 ? octurn::corners_of(argv[1]) : std::vector<Eigen::Vector3d>();
  if (corners.empty()) {
    std::cerr << "usage: model_error Scan.stl, with triangles" << std::endl;
    return 2;
  }
  octurn::print_error(corners);
  return 0;
}
