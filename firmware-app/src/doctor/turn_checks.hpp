#pragma once

#include <nlohmann/json.hpp>
#include <vector>

#include "doctor/finding.hpp"
#include "doctor/measure_turn.hpp"
#include "doctor/tune_motion.hpp"
#include "turntable/stepper_settings.hpp"

namespace octurn {

/// A finding about the turntable's motion, and the setting that corrects it.
struct TurnFinding {
  Finding finding = {};
  nlohmann::json set = nlohmann::json::object();  ///< of "turntable" in octurn.json; empty: none
};

/// Checks direction, size of a turn, backlash, return and swinging of a measured turn.
/// @param settings  in force during the measurement
std::vector<TurnFinding> check_turn(const TurnMeasurement& turn, const StepperSettings& settings);

/// Whether a turn came out whole, and no step was lost.
bool is_whole_turn(const TurnMeasurement& turn);

/// Whether the motor has a margin at the configured speeds; proposes others otherwise.
TurnFinding check_motion(const MotionLimits& limits, const StepperSettings& settings);

/// Measures a turn at half of the configured speeds, so that lost steps do not distort it, checks
/// it, and, if it is whole, finds out which speeds lose no step.
/// @throws Stopped, Error  as `measure_turn`
std::vector<TurnFinding> test_turn(Rig& rig, const StepperSettings& settings,
                                   const Eigen::Isometry3d& platform_from_sensor, const Box& clip,
                                   const std::stop_token& stop,
                                   const std::function<void(double done)>& on_progress);

}  // namespace octurn
