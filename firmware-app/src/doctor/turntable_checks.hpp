#pragma once

#include <chrono>
#include <variant>

#include "doctor/finding.hpp"
#include "store/job.hpp"
#include "turntable/gpio_lines.hpp"
#include "turntable/real_time.hpp"

namespace octurn {

/// State of the GPIO lines, or why it cannot be read.
using HeaderState = std::variant<HeaderUse, Failure>;

/// Who holds the GPIO lines whose consumer is called "octurn".
enum class LineOwner {
  this_program,  ///< or its daemon, to drive the turntable
  another,
};

/// Reads the state of a turntable's lines. Neither requests nor changes a line.
HeaderState read_gpio_header(const std::vector<NamedLine>& lines);

Finding check_gpio_chip(const HeaderState& header);
Finding check_gpio_lines(const HeaderState& header, LineOwner owner);

/// Whether the thread that makes the pulses wakes up in time under the machine's present load.
/// @param limit  maximum lateness of a wake-up
Finding check_wake_ups(const Lateness& lateness, std::chrono::steady_clock::duration limit);

/// The finding that replaces those of the GPIO for a simulated turntable.
Finding check_simulated_turntable();

}  // namespace octurn
