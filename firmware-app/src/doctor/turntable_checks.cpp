#include "doctor/turntable_checks.hpp"

#include <string>

namespace octurn {
namespace {

constexpr Check gpio_chip{"gpio-chip", "GPIO chip"};
constexpr Check gpio_lines{"gpio-lines", "GPIO lines"};
constexpr Check wake_ups{"wake-ups", "Pulses in time"};
constexpr Check turntable_check{"turntable", "Turntable"};

void append_item(std::string& list, const std::string& item) {
  list += (list.empty() ? "" : ", ") + item;
}

}  // namespace

HeaderState read_gpio_header(const std::vector<NamedLine>& lines) {
  try {
    return read_header_use(lines);
  } catch (const Error& error) {
    return to_failure(error);
  }
}

Finding check_gpio_chip(const HeaderState& header) {
  if (const auto* failure = std::get_if<Failure>(&header)) {
    return gpio_chip.fault(failure->detail, failure->hint);
  }
  return gpio_chip.ok(std::get<HeaderUse>(header).label);
}

Finding check_gpio_lines(const HeaderState& header, LineOwner owner) {
  const auto* use = std::get_if<HeaderUse>(&header);
  if (use == nullptr) {
    return gpio_lines.unknown("there is no GPIO chip to look at");
  }
  std::string free;
  std::string held;
  std::string used;
  std::string missing;
  for (const LineUse& line : use->lines) {
    if (!line.exists) {
      append_item(missing, line.name);
    } else if (!line.user) {
      append_item(free, line.name);
    } else if (*line.user == gpio_user && owner == LineOwner::this_program) {
      append_item(held, line.name);
    } else {
      append_item(used, line.name + " in use by " + *line.user);
    }
  }
  if (!missing.empty()) {
    return gpio_lines.fault(
        "there is no " + missing,
        "Correct the turntable's lines in octurn.json; they are called GPIO2 to GPIO27.");
  }
  if (!used.empty()) {
    return gpio_lines.fault(used,
                            "End what uses them, or choose other lines in octurn.json and rewire.");
  }
  return gpio_lines.ok(held.empty()   ? free + " free"
                       : free.empty() ? held + " held by Octurn"
                                      : held + " held by Octurn, " + free + " free");
}

Finding check_wake_ups(const Lateness& lateness, std::chrono::steady_clock::duration limit) {
  const auto milliseconds = [](std::chrono::steady_clock::duration time) {
    return rounded(std::chrono::duration<double, std::milli>(time).count(), 2) + " ms";
  };
  const std::string measured = std::to_string(lateness.size()) + " wake-ups, half of them within " +
                               milliseconds(lateness[lateness.size() / 2]) + " and all within " +
                               milliseconds(lateness.back());
  return lateness.back() <= limit
             ? wake_ups.ok(measured)
             : wake_ups.warning(measured,
                                "End other programs on this machine: late pulses lose no step, but "
                                "the platform turns more slowly.");
}

Finding check_simulated_turntable() { return turntable_check.ok("simulated: it needs no GPIO"); }

}  // namespace octurn
