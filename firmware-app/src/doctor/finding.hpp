#pragma once

#include <nlohmann/json_fwd.hpp>
#include <span>
#include <string>
#include <string_view>

namespace octurn {

/// A remedy for a finding that the page offers as a button.
enum class Action {
  none,
  measure_turn,   ///< solve the sensor's pose with one turn of the platform
  set_pose,       ///< set the pose by hand, as it is too far off for a turn
  open_settings,  ///< review the settings and save them
  choose_scans,   ///< choose scans to delete
};

/// Result of one check of the doctor.
struct Finding {
  enum class State {
    ok,
    warning,  ///< scans work, but not as well as they could
    fault,    ///< scans do not work, or will soon not
    unknown,  ///< not measured; no fault
  };
  std::string check = {};  ///< identifier: "frame-rate"
  std::string name = {};   ///< display name: "Frame rate"
  State state = State::unknown;
  std::string measured = {};  ///< with units
  std::string advice = {};    ///< what to do, in one sentence; empty: nothing
  Action action = Action::none;
  friend bool operator==(const Finding&, const Finding&) = default;
};

/// One check of the doctor. Its functions make its findings.
struct Check {
  std::string_view id;
  std::string_view name;

  Finding ok(std::string measured) const;
  Finding warning(std::string measured, std::string advice, Action action = Action::none) const;
  Finding fault(std::string measured, std::string advice, Action action = Action::none) const;
  Finding unknown(std::string measured, std::string advice = {}) const;
};

std::string_view to_string(Finding::State state);

/// The identifier of an action in JSON: "measure-turn"; empty for none.
std::string_view to_string(Action action);

/// The worst state: fault or warning if any finding has it, otherwise ok.
Finding::State overall_state(std::span<const Finding> findings);

/// A number with `digits` digits after the point. Zero has no sign.
std::string rounded(double value, int digits);

/// A size as text in decimal units, as disks are sold: "512 MB", "12.3 GB".
std::string readable_bytes(double bytes);

/// The report of `octurn doctor --json` and of the API. Version and time are part of it, so that a
/// saved report can be read on its own.
nlohmann::json to_json(std::span<const Finding> findings);

}  // namespace octurn
