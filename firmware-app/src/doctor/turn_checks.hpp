#pragma once

#include <nlohmann/json.hpp>
#include <vector>

#include "doctor/finding.hpp"
#include "doctor/measure_turn.hpp"
#include "turntable/stepper_settings.hpp"

namespace octurn {

/// A finding about the turntable's motion, and the setting that cures it.
struct TurnFinding {
  Finding finding = {};
  nlohmann::json set = nlohmann::json::object();  ///< of "turntable" in octurn.json; empty: none
};

/// What a measured turn says of direction, size of a turn, play and return.
/// @param settings  that the turn was made with
std::vector<TurnFinding> check_turn(const TurnMeasurement& turn, const StepperSettings& settings);

}  // namespace octurn
