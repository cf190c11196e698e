#pragma once

#include <variant>

#include "doctor/finding.hpp"
#include "scan/job.hpp"
#include "turntable/gpio_lines.hpp"

namespace octurn {

/// What the GPIO header is, or why it cannot be looked at.
using HeaderLook = std::variant<HeaderUse, Failure>;

/// Whose the lines are that go by Octurn's name.
enum class LineOwner {
  this_program,  ///< or a daemon of it, whose turntable they drive
  another,
};

/// Looks at the lines of a turntable. Moves nothing, and takes hold of nothing.
HeaderLook look_at_gpio(const std::vector<NamedLine>& lines);

Finding check_gpio_chip(const HeaderLook& header);
Finding check_gpio_lines(const HeaderLook& header, LineOwner owner);

/// The two for a turntable that is simulated.
Finding check_simulated_turntable();

}  // namespace octurn
