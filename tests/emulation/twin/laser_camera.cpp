// laser_camera WIDTH HEIGHT FX FY CX CY: renders the pictures of the twin's camera with line
// lasers. For each line "ANGLE LASER" on its standard input it writes one picture to its standard
// output: WIDTH x HEIGHT bytes of luminance, row by row. ANGLE is the platform's, radians,
// counter-clockwise seen from above; LASER is the one that is lit, "left" or "right", or "none".
//
// The rig is the drawing's, but its lasers were turned in their holders as those of `octurn scan
// --simulate-laser`: a scan has to find that.

#include <algorithm>
#include <array>
#include <charconv>
#include <cstddef>
#include <cstring>
#include <iostream>
#include <numbers>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "octurn/units.hpp"
#include "rig/nominal_laser_rig.hpp"
#include "simulator/laser_scene.hpp"

namespace octurn {
namespace {

constexpr double left_turn_deg = 0.06;
constexpr double right_turn_deg = -0.04;

double number_from(const char* word) {
  double number = 0;
  const char* const end = word + std::strlen(word);
  if (std::from_chars(word, end, number).ptr != end) {
    throw std::invalid_argument(std::string(word) + " is no number");
  }
  return number;
}

Laser turned_laser(const std::string& name, double azimuth, double turn_deg) {
  const Eigen::Vector3d up =
      nominal_platform_from_camera().linear().transpose() * Eigen::Vector3d::UnitZ();
  return turned_in_holder(nominal_laser(name, azimuth), up, radians_from_degrees(turn_deg));
}

LaserSimulation simulation_of(const Intrinsics& lens) {
  return {.lens = lens,
          .platform_from_sensor = nominal_platform_from_camera(),
          .lasers = {turned_laser("left", -std::numbers::pi / 6, left_turn_deg),
                     turned_laser("right", std::numbers::pi / 6, right_turn_deg)}};
}

/// The index of a laser; nothing for "none".
std::optional<std::size_t> index_of(const std::string& laser, const std::vector<Laser>& lasers) {
  if (laser == "none") {
    return std::nullopt;
  }
  const auto found = std::ranges::find(lasers, laser, &Laser::name);
  if (found == lasers.end()) {
    throw std::invalid_argument("there is no laser " + laser);
  }
  return static_cast<std::size_t>(found - lasers.begin());
}

/// Renders until the standard input ends.
void render(const Intrinsics& lens) {
  const LaserSimulation simulation = simulation_of(lens);
  LaserScene scene(simulation);
  double angle = 0;
  std::string laser;
  while (std::cin >> angle >> laser) {
    const Picture picture = scene.expose(angle, index_of(laser, simulation.lasers));
    std::cout.write(reinterpret_cast<const char*>(picture.samples.data()),
                    static_cast<std::streamsize>(picture.samples.size()));
    std::cout.flush();
  }
}

}  // namespace
}  // namespace octurn

int main(int argc, char** argv) {
  if (argc != 7) {
    std::cerr << "usage: laser_camera WIDTH HEIGHT FX FY CX CY" << std::endl;
    return 2;
  }
  try {
    std::array<double, 6> numbers = {};
    std::transform(argv + 1, argv + argc, numbers.begin(), &octurn::number_from);
    octurn::render({.width = static_cast<int>(numbers[0]),
                    .height = static_cast<int>(numbers[1]),
                    .fx = numbers[2],
                    .fy = numbers[3],
                    .cx = numbers[4],
                    .cy = numbers[5]});
    return 0;
  } catch (const std::exception& error) {
    std::cerr << "laser_camera: " << error.what() << std::endl;
    return 1;
  }
}
