#pragma once

#include <variant>

#include "doctor/finding.hpp"
#include "scan/job.hpp"
#include "turntable/gpio_lines.hpp"

namespace octurn {

/// State of the GPIO lines, or why it cannot be read.
using HeaderState = std::variant<HeaderUse, Failure>;

/// Who holds the GPIO lines whose consumer is called "octurn".
enum class LineOwner {
  this_program,  ///< or a daemon of it, whose turntable they drive
  another,
};

/// Reads the state of a turntable's lines. Neither requests nor changes a line.
HeaderState read_gpio_header(const std::vector<NamedLine>& lines);

Finding check_gpio_chip(const HeaderState& header);
Finding check_gpio_lines(const HeaderState& header, LineOwner owner);

/// The finding in place of both for a simulated turntable.
Finding check_simulated_turntable();

}  // namespace octurn
