#include <functional>
#include <memory>

#include "calibration/lens_files.hpp"
#include "camera/simulated_camera.hpp"
#include "commands/commands.hpp"
#include "octurn/units.hpp"
#include "rig/nominal_laser_rig.hpp"
#include "rig/simulation.hpp"
#include "sensor/simulated_mechanism.hpp"

namespace octurn {
namespace {

/// The simulated platform's motion. If its gear ratio or wiring differs from the settings, its rate
/// is not 1.
SimulatedMechanism to_mechanism(const RigArguments& arguments, const StepperSettings& stepper) {
  const double rate = stepper.gear_ratio / arguments.gear_ratio.value_or(stepper.gear_ratio);
  const bool is_right = !arguments.reversed || stepper.reversed;
  return {.rate = is_right ? rate : -rate, .play = radians_from_degrees(arguments.play_deg)};
}

/// Returns `open_sensor`, or a function that also simulates the mechanism if that has faults.
std::function<std::unique_ptr<DepthSensor>(const std::string& uri)> sensor_opener(
    const SimulatedMechanism& mechanism) {
  if (mechanism.rate == 1 && mechanism.play == 0) {
    return open_sensor;
  }
  return [mechanism](const std::string& uri) { return on_mechanism(open_sensor(uri), mechanism); };
}

// Rotation of a simulated rig's lasers in their holders since their planes were measured.
constexpr double left_turn_deg = 0.06;  // 0.35 mm at the platform's axis
constexpr double right_turn_deg = -0.04;

/// Changes a lens as much as lenses of different makes differ.
CameraLens other_lens(CameraLens lens) {
  Intrinsics& in = lens.intrinsics;
  in.fx *= 1.012;
  in.fy *= 1.010;
  in.cx += 0.006 * in.width;
  in.cy -= 0.006 * in.height;
  lens.k1 -= 0.06;
  lens.k2 += 0.02;
  return lens;
}

/// The simulated rig's true geometry, from which the configured one may differ.
LaserSimulation to_simulation(const RigArguments& arguments, const LaserSettings& configured) {
  const CameraLens lens =
      arguments.other_lens ? other_lens(told_lens(configured)) : told_lens(configured);
  LaserSimulation simulation{.mesh_file = arguments.mesh_file,
                             .lens = lens.intrinsics,
                             .k1 = lens.k1,
                             .k2 = lens.k2,
                             .platform_from_sensor = configured.platform_from_sensor,
                             .lasers = laser_camera(configured).lasers};
  const Eigen::Vector3d up =
      configured.platform_from_sensor.linear().transpose() * Eigen::Vector3d::UnitZ();
  for (Laser& laser : simulation.lasers) {
    const double turn_deg =
        laser.name == configured.left.laser.name ? left_turn_deg : right_turn_deg;
    laser = turned_in_holder(laser, up, arguments.perfect ? 0 : radians_from_degrees(turn_deg));
  }
  return simulation;
}

/// The motion of a simulated turntable: the configured speeds, by quarter steps on the shaft.
Motion to_simulated_motion(const StepperSettings& configured) {
  const StepperSettings documented;
  StepperSettings simulated = configured;
  simulated.microsteps = documented.microsteps;
  simulated.full_steps = documented.full_steps;
  simulated.gear_ratio = documented.gear_ratio;
  return to_motion(simulated);
}

/// What a simulated turntable turns; nothing if it has no weight.
std::optional<PlatformLoad> load_of(const RigArguments& arguments) {
  // A recording shows what was seen at an angle, and not at one that a heavy platform swings to.
  const bool has_weight = !arguments.perfect && arguments.sensor_uri.empty();
  return has_weight ? std::optional(arguments.load) : std::nullopt;
}

RigOptions laser_rig_options(const RigArguments& arguments, const Config& config) {
  if (!arguments.simulate) {
    return {.stepper = config.turntable, .laser = config.laser};
  }
  return {
      .speed = arguments.speed,
      .motion = to_simulated_motion(config.turntable),
      .load = load_of(arguments),
      .laser = config.laser,
      .open_camera = [simulation = to_simulation(arguments, config.laser), speed = arguments.speed,
                      late = arguments.late_pictures](const LaserSettings&) {
        return simulate_laser_rig(simulation, speed, late);
      }};
}

RigOptions options_of(const RigArguments& arguments, const Config& config) {
  if (config.sensor == SensorKind::laser_line) {
    return laser_rig_options(arguments, config);
  }
  if (!arguments.simulate) {
    return {.sensor_uri = arguments.sensor_uri, .stepper = config.turntable};
  }
  const double imperfection = arguments.perfect ? 0 : 1;
  const std::string simulated = simulation_uri({.mesh_file = arguments.mesh_file,
                                                .pattern = imperfection,
                                                .unit = arguments.perfect ? 0 : arguments.unit,
                                                .misalignment = imperfection,
                                                .wall = arguments.wall,
                                                .speed = arguments.speed});
  return {.sensor_uri = arguments.sensor_uri.empty() ? simulated : arguments.sensor_uri,
          .speed = arguments.speed,
          .motion = to_simulated_motion(config.turntable),
          .load = load_of(arguments),
          .open_sensor = sensor_opener(to_mechanism(arguments, config.turntable))};
}

}  // namespace

RigOptions rig_options(const RigArguments& arguments, const Config& config) {
  RigOptions options = options_of(arguments, config);
  if (config.keep_sensor_on) {
    options.sensor_off_after.reset();
  }
  return options;
}

}  // namespace octurn
