#pragma once

#include <nlohmann/json.hpp>
#include <vector>

#include "doctor/finding.hpp"
#include "doctor/measure_turn.hpp"
#include "turntable/stepper_settings.hpp"

namespace octurn {

/// A finding about the turntable's motion, and the setting that corrects it.
struct TurnFinding {
  Finding finding = {};
  nlohmann::json set = nlohmann::json::object();  ///< of "turntable" in octurn.json; empty: none
};

/// Checks direction, size of a turn, backlash and return of a measured turn.
/// @param settings  in force during the measurement
std::vector<TurnFinding> check_turn(const TurnMeasurement& turn, const StepperSettings& settings);

}  // namespace octurn
