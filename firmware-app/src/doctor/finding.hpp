#pragma once

#include <nlohmann/json_fwd.hpp>
#include <span>
#include <string>
#include <string_view>

namespace octurn {

/// What one check of the doctor has found.
struct Finding {
  enum class State {
    ok,
    warning,  ///< scans work, but not as well as they could
    fault,    ///< scans do not work, or will soon not
    unknown,  ///< not measured, which is no fault
  };
  std::string check = {};  ///< for programs: "frame-rate"
  std::string name = {};   ///< for people: "Frame rate"
  State state = State::unknown;
  std::string measured = {};  ///< with its units
  std::string advice = {};    ///< what to do, in one sentence; empty if nothing is
};

/// What is checked. Makes the findings of it.
struct Check {
  std::string_view id;
  std::string_view name;

  Finding ok(std::string measured) const;
  Finding warning(std::string measured, std::string advice) const;
  Finding fault(std::string measured, std::string advice) const;
  Finding unknown(std::string measured, std::string advice = {}) const;
};

std::string_view name_of(Finding::State state);

/// The state of the whole: fault or warning if there is one, otherwise ok.
Finding::State worst(std::span<const Finding> findings);

/// A number with so many digits after the point.
std::string rounded(double value, int digits);

/// A size as people read it and disks are sold, in powers of 1000: "512 MB", "12.3 GB".
std::string readable_bytes(double bytes);

/// The findings as `octurn doctor --json` and the API have them, with version and time, so that
/// they can stand alone.
nlohmann::json json_of(std::span<const Finding> findings);

}  // namespace octurn
