#include "turntable/stepper_settings.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>

#include "octurn/json_object.hpp"

namespace octurn {
namespace {

using nlohmann::json;
using std::chrono::milliseconds;

/// Levels of MS1, MS2 and MS3 (A4988 datasheet, table 1).
struct Microstepping {
  int microsteps;
  std::array<bool, 3> levels;
};
constexpr std::array<Microstepping, 5> microsteppings = {{{1, {false, false, false}},
                                                          {2, {true, false, false}},
                                                          {4, {false, true, false}},
                                                          {8, {true, true, false}},
                                                          {16, {true, true, true}}}};

constexpr int max_full_steps = 1000;
constexpr double max_ratio = 1000;
// Steps a second. Slower, a stop request would wait for more than a frame of the sensor; faster,
// Linux is no longer on time.
constexpr double min_speed = 40;
constexpr double max_speed = 5000;
constexpr double max_ramp = 1e6;
constexpr int min_idle_s = 10;  // a stop of a scan takes 3 s, with the most frames

/// The keys of the lines of `lines_of`, in its order.
constexpr std::array<const char*, 6> line_keys = {"step_line",       "direction_line",
                                                  "enable_line",     "microstep_lines",
                                                  "microstep_lines", "microstep_lines"};

std::vector<std::string> microstep_lines_from(const JsonObject& keys, const json& names) {
  if (!names.is_array() || (!names.empty() && names.size() != 3) ||
      !std::ranges::all_of(names, [](const json& name) { return name.is_string(); })) {
    keys.refuse("microstep_lines", names, "the names of three lines, or of none");
  }
  return names.get<std::vector<std::string>>();
}

void read_lines(JsonObject& keys, StepperSettings& settings) {
  settings.step_line = keys.text("step_line").value_or(settings.step_line);
  settings.direction_line = keys.text("direction_line").value_or(settings.direction_line);
  settings.enable_line = keys.text("enable_line").value_or(settings.enable_line);
  if (const json* names = keys.find("microstep_lines")) {
    settings.microstep_lines = microstep_lines_from(keys, *names);
  }
  const std::vector<NamedLine> lines = lines_of(settings);
  for (std::size_t line = 1; line < lines.size(); ++line) {
    const auto end = lines.begin() + static_cast<std::ptrdiff_t>(line);
    if (std::ranges::find(lines.begin(), end, lines[line].name, &NamedLine::name) != end) {
      keys.refuse(line_keys.at(line), lines[line].name, "a line that no other signal has");
    }
  }
}

void read_gear(JsonObject& keys, StepperSettings& settings) {
  if (const auto microsteps = keys.whole_number("microsteps", 1, 16)) {
    if (std::ranges::find(microsteppings, *microsteps, &Microstepping::microsteps) ==
        microsteppings.end()) {
      keys.refuse("microsteps", *microsteps, "1, 2, 4, 8 or 16");
    }
    settings.microsteps = *microsteps;
  }
  settings.full_steps =
      keys.whole_number("full_steps", 4, max_full_steps).value_or(settings.full_steps);
  settings.gear_ratio =
      keys.number("gear_ratio", 1 / max_ratio, max_ratio).value_or(settings.gear_ratio);
  settings.reversed = keys.flag("reversed").value_or(settings.reversed);
  constexpr int min_steps = 4;  // a quarter turn each: fewer is no turntable
  const int steps = motion_of(settings).steps_per_turn;
  if (steps < min_steps) {
    keys.refuse("gear_ratio", settings.gear_ratio, "such that a turn has 4 steps or more");
  }
  settings.take_up_steps =
      keys.whole_number("take_up_steps", 0, steps).value_or(settings.take_up_steps);
}

void read_motion(JsonObject& keys, StepperSettings& settings) {
  settings.speed_steps_per_second = keys.number("speed_steps_per_s", min_speed, max_speed)
                                        .value_or(settings.speed_steps_per_second);
  settings.start_speed_steps_per_second =
      std::min(settings.start_speed_steps_per_second, settings.speed_steps_per_second);
  settings.start_speed_steps_per_second =
      keys.number("start_speed_steps_per_s", min_speed, settings.speed_steps_per_second)
          .value_or(settings.start_speed_steps_per_second);
  settings.ramp_steps_per_second2 =
      keys.number("ramp_steps_per_s2", 1, max_ramp).value_or(settings.ramp_steps_per_second2);
  if (const auto ms = keys.whole_number("settle_ms", 0, 10'000)) {
    settings.settle_time = milliseconds(*ms);
  }
  if (const auto seconds = keys.whole_number("idle_release_s", min_idle_s, 24 * 3600)) {
    settings.idle_release = std::chrono::seconds(*seconds);
  }
}

}  // namespace

StepperSettings stepper_settings_from(const json& object) {
  JsonObject keys(object, "bad-config", "turntable");
  StepperSettings settings;
  read_lines(keys, settings);
  read_gear(keys, settings);
  read_motion(keys, settings);
  keys.refuse_unread();
  return settings;
}

json json_of(const StepperSettings& settings) {
  using std::chrono::duration_cast;
  return {{"step_line", settings.step_line},
          {"direction_line", settings.direction_line},
          {"enable_line", settings.enable_line},
          {"microstep_lines", settings.microstep_lines},
          {"microsteps", settings.microsteps},
          {"full_steps", settings.full_steps},
          {"gear_ratio", settings.gear_ratio},
          {"reversed", settings.reversed},
          {"speed_steps_per_s", settings.speed_steps_per_second},
          {"start_speed_steps_per_s", settings.start_speed_steps_per_second},
          {"ramp_steps_per_s2", settings.ramp_steps_per_second2},
          {"settle_ms", settings.settle_time.count()},
          {"idle_release_s", duration_cast<std::chrono::seconds>(settings.idle_release).count()},
          {"take_up_steps", settings.take_up_steps}};
}

Motion motion_of(const StepperSettings& settings) {
  const double steps = settings.full_steps * settings.microsteps * settings.gear_ratio;
  return {.steps_per_turn = static_cast<int>(std::lround(steps)),
          .start_steps_per_second = settings.start_speed_steps_per_second,
          .top_steps_per_second = settings.speed_steps_per_second,
          .ramp_steps_per_second2 = settings.ramp_steps_per_second2,
          .settle_time = settings.settle_time};
}

std::vector<NamedLine> lines_of(const StepperSettings& settings) {
  std::vector<NamedLine> lines = {{.name = settings.step_line, .high = false},
                                  {.name = settings.direction_line, .high = false},
                                  {.name = settings.enable_line, .high = true}};
  const auto* levels =
      std::ranges::find(microsteppings, settings.microsteps, &Microstepping::microsteps);
  for (std::size_t line = 0; line < settings.microstep_lines.size(); ++line) {
    lines.push_back({.name = settings.microstep_lines[line], .high = levels->levels[line]});
  }
  return lines;
}

}  // namespace octurn
