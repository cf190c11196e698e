// The module that simulates a camera with line lasers.

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "rig/laser_simulation.hpp"
#include "simulator/laser_scene.hpp"
#include "simulator/lens_distortion.hpp"
#include "simulator/waved_board.hpp"

namespace octurn {
namespace {

std::vector<std::uint8_t> distorted_colours(const std::vector<Rgb>& colours,
                                            const LaserSimulation& simulation) {
  return distorted(std::span(colours.data()->data(), 3 * colours.size()), 3, simulation);
}

/// A scene, or a board in front of it, through a lens with distortion.
class SceneThroughLens final : public LaserSimulator {
 public:
  explicit SceneThroughLens(const LaserSimulation& simulation)
      : simulation_(simulation), scene_(simulation) {}

  void set_object_pose(int pose) override { scene_.set_object_pose(pose); }

  Picture expose(double angle, std::optional<std::size_t> lit) override {
    Picture picture = scene_.expose(angle, lit);
    if (distorts()) {
      picture.samples = distorted(picture.samples, 1, simulation_);
    }
    return picture;
  }

  ColourExposure expose_in_colour(double angle, std::optional<std::size_t> lit) override {
    ColourExposure seen = scene_.expose_in_colour(angle, lit);
    if (distorts()) {
      seen.picture.samples = distorted(seen.picture.samples, 1, simulation_);
      const std::vector<std::uint8_t> shown = distorted_colours(seen.colours, simulation_);
      for (std::size_t pixel = 0; pixel < seen.colours.size(); ++pixel) {
        std::copy_n(shown.begin() + static_cast<std::ptrdiff_t>(3 * pixel), 3,
                    seen.colours[pixel].begin());
      }
    }
    return seen;
  }

  Picture expose_board(int number) override {
    if (!board_) {
      board_.emplace(simulation_);
    }
    return board_->picture(number);
  }

 private:
  bool distorts() const { return simulation_.k1 != 0 || simulation_.k2 != 0; }

  LaserSimulation simulation_;
  LaserScene scene_;
  std::optional<WavedBoard> board_ = {};  // once it is shown
};

std::unique_ptr<LaserSimulator> make(const LaserSimulation& simulation) {
  return std::make_unique<SceneThroughLens>(simulation);
}

}  // namespace
}  // namespace octurn

extern "C" __attribute__((visibility("default")))
const octurn::LaserSimulatorModule octurn_laser_simulator;
extern "C" const octurn::LaserSimulatorModule octurn_laser_simulator{.make = octurn::make};
