#include "turntable/stepper_settings.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>

#include "settings/field.hpp"

namespace octurn {

std::string_view to_string(StepperDriver driver) {
  switch (driver) {
    case StepperDriver::drv8825:
      return "DRV8825";
    case StepperDriver::tmc2209:
      return "TMC2209";
    case StepperDriver::a4988:
      break;
  }
  return "A4988";
}

std::vector<Microstepping> microsteppings(StepperDriver driver) {
  constexpr bool low = false;
  constexpr bool high = true;
  switch (driver) {
    case StepperDriver::drv8825:  // TI's datasheet SLVSA73, table 1
      return {{1, {low, low, low}},   {2, {high, low, low}},  {4, {low, high, low}},
              {8, {high, high, low}}, {16, {low, low, high}}, {32, {high, low, high}}};
    case StepperDriver::tmc2209:  // Trinamic's datasheet, section 3.3: 8 comes first
      return {{8, {low, low}}, {16, {high, high}}, {32, {high, low}}, {64, {low, high}}};
    case StepperDriver::a4988:  // Allegro's datasheet, table 1
      break;
  }
  return {{1, {low, low, low}},
          {2, {high, low, low}},
          {4, {low, high, low}},
          {8, {high, high, low}},
          {16, {high, high, high}}};
}

namespace {

using nlohmann::json;

constexpr int max_full_steps = 4096;  // a 28BYJ-48's half steps, gears included
constexpr double max_ratio = 1000;
constexpr double min_speed = 2;  // degrees a second; slower, a full step takes a second
constexpr double max_speed = 3600;
constexpr double max_acceleration = 1e6;
constexpr double max_pulse_rate = 5000;  // a second: beyond that Linux does not wake up in time
constexpr int min_steps = 4;             // in a turn: fewer are no turntable
constexpr int max_steps = 16'000'000;
constexpr int max_settle_ms = 10'000;
constexpr int min_idle_s = 10;  // a scan stays at a stop for up to 3 s, with the most frames
constexpr int max_idle_s = 24 * 3600;

/// The settings' keys of the lines that `to_gpio_lines` returns, in the same order.
constexpr std::array<const char*, 6> line_keys = {"step_line",       "direction_line",
                                                  "enable_line",     "microstep_lines",
                                                  "microstep_lines", "microstep_lines"};

void check_microsteps(const JsonObject& keys, const StepperSettings& settings) {
  const std::vector<Microstepping> all = microsteppings(settings.driver);
  if (std::ranges::find(all, settings.microsteps, &Microstepping::microsteps) == all.end()) {
    std::string allowed = "for a driver " + std::string(to_string(settings.driver)) + " one of";
    for (const Microstepping& one : all) {
      allowed += (&one == &all.front() ? " " : ", ") + std::to_string(one.microsteps);
    }
    keys.refuse("microsteps", settings.microsteps, allowed);
  }
  const std::size_t inputs = all.front().levels.size();
  if (!settings.lines.microsteps.empty() && settings.lines.microsteps.size() != inputs) {
    keys.refuse(
        "microstep_lines", settings.lines.microsteps,
        "the names of " + std::string(inputs == 2 ? "two" : "three") + " lines, or of none");
  }
}

void check_lines(const JsonObject& keys, const StepperSettings& settings) {
  const std::vector<NamedLine> lines = to_gpio_lines(settings);
  for (std::size_t line = 1; line < lines.size(); ++line) {
    const auto end = lines.begin() + static_cast<std::ptrdiff_t>(line);
    if (std::ranges::find(lines.begin(), end, lines[line].name, &NamedLine::name) != end) {
      keys.refuse(line_keys.at(line), lines[line].name, "a line that no other signal has");
    }
  }
}

/// Reads the speeds and the ramp of version 0.1, in steps; the keys in degrees come first.
void read_speeds_in_steps(JsonObject& keys, StepperSettings& settings, int steps_per_turn) {
  struct Old {
    const char* in_steps;
    double min;
    double max;
    const char* in_degrees;
    double& value;
  };
  for (const Old& old : {Old{"speed_steps_per_s", 40, max_pulse_rate, "speed_deg_per_s",
                             settings.speed_deg_per_second},
                         Old{"start_speed_steps_per_s", 40, max_pulse_rate, "start_speed_deg_per_s",
                             settings.start_speed_deg_per_second},
                         Old{"ramp_steps_per_s2", 1, 1e6, "acceleration_deg_per_s2",
                             settings.acceleration_deg_per_second2}}) {
    const auto in_steps = keys.number(old.in_steps, old.min, old.max);
    if (in_steps && !keys.value(old.in_degrees)) {
      old.value = *in_steps * 360 / steps_per_turn;
    }
  }
}

std::vector<Field> line_fields(StepperLines& lines) {
  return {
      {.key = "step_line",
       .unit = "line",
       .help = "to the driver's STEP. Lines have the names of the Pi's documentation, `GPIO2` to "
               "`GPIO27`",
       .access = text(lines.step)},
      {.key = "direction_line", .unit = "line", .help = "to DIR", .access = text(lines.direction)},
      {.key = "enable_line",
       .unit = "line",
       .help = "to ENABLE. Of `GPIO4` to `GPIO8`, which are pulled up while the Pi boots, so that "
               "the motor is off",
       .access = text(lines.enable)},
      {.key = "microstep_lines",
       .unit = "lines",
       .help = "to MS1, MS2 and MS3 of an A4988, MODE0 to MODE2 of a DRV8825, MS1 and MS2 of a "
               "TMC2209; empty if these are wired to fixed levels",
       .access = texts(lines.microsteps)},
  };
}

std::vector<Field> gear_fields(StepperSettings& s) {
  return {
      {.key = "driver",
       .help = "of the motor; which microsteps it makes, and by which levels",
       .access = choice(s.driver,
                        {StepperDriver::a4988, StepperDriver::drv8825, StepperDriver::tmc2209})},
      {.key = "microsteps",
       .unit = "in a full step",
       .help = "must match the levels where these are fixed. 1 to 16 with an A4988, to 32 with a "
               "DRV8825, 8 to 64 with a TMC2209",
       .access = one_of(s.microsteps, {1, 2, 4, 8, 16, 32, 64})},
      {.key = "full_steps",
       .unit = "in a turn of the motor",
       .help =
           "a motor of 1.8 degrees has 200, one of 0.9 degrees 400, a 28BYJ-48 2,048 by full and "
           "4,096 by half steps",
       .access = whole(s.full_steps, 4, max_full_steps)},
      {.key = "gear_ratio",
       .unit = "motor turns in a platform turn",
       .help = "teeth of the platform's wheel by teeth of the motor's",
       .access = number(s.gear_ratio, 1 / max_ratio, max_ratio)},
      {.key = "reversed",
       .help = "`true` if the platform turns clockwise, seen from above, where it should turn the "
               "other way",
       .access = flag(s.reversed)},
  };
}

std::vector<Field> motion_fields(StepperSettings& s) {
  return {
      {.key = "speed_deg_per_s",
       .unit = "degrees a second",
       .help = "of the platform in a long move; the motor makes at most 5,000 microsteps a second",
       .access = number(s.speed_deg_per_second, min_speed, max_speed)},
      {.key = "start_speed_deg_per_s",
       .unit = "degrees a second",
       .help = "at which a move begins and ends; at most the speed. Lower it first where a heavy "
               "platform loses steps",
       .access = number(s.start_speed_deg_per_second, min_speed, max_speed)},
      {.key = "acceleration_deg_per_s2",
       .unit = "degrees a second, each second",
       .help = "how quickly speed is gained, and lost again",
       .access = number(s.acceleration_deg_per_second2, 1, max_acceleration)},
      {.key = "settle_ms",
       .unit = "ms",
       .help = "how long the platform swings after a move; frames are taken after it",
       .access = milliseconds(s.settle_time, 0, max_settle_ms),
       .default_text = "`300`, with lasers `150`"},
      {.key = "idle_release_s",
       .unit = "s",
       .help = "time without a move after which the motor is switched off; a scan switches it off "
               "at its end",
       .access = seconds(s.idle_release, min_idle_s, max_idle_s)},
      {.key = "take_up_steps",
       .unit = "steps",
       .help = "against the play of gears: before a scan and after a move backwards, the platform "
               "goes this far too far back and comes forward again. More than the play, at most a "
               "turn; 0 for a platform on the motor's shaft",
       .access = whole(s.take_up_steps, 0, max_steps)},
  };
}

}  // namespace

std::vector<Field> fields(StepperSettings& settings) {
  std::vector<Field> all = line_fields(settings.lines);
  for (const std::vector<Field>& more : {gear_fields(settings), motion_fields(settings)}) {
    all.insert(all.end(), more.begin(), more.end());
  }
  return all;
}

void check_stepper_settings(JsonObject& keys, StepperSettings& settings) {
  check_microsteps(keys, settings);
  check_lines(keys, settings);
  const int steps = to_motion(settings).steps_per_turn;
  if (steps < min_steps) {
    keys.refuse("gear_ratio", settings.gear_ratio, "such that a turn has 4 steps or more");
  }
  read_speeds_in_steps(keys, settings, steps);
  if (settings.take_up_steps > steps) {
    keys.refuse("take_up_steps", settings.take_up_steps,
                "a whole number from 0 to " + std::to_string(steps) + ", a turn");
  }
  double& start = settings.start_speed_deg_per_second;
  if (start > settings.speed_deg_per_second && keys.value("start_speed_deg_per_s")) {
    keys.refuse("start_speed_deg_per_s", start, "at most speed_deg_per_s");
  }
  start = std::min(start, settings.speed_deg_per_second);
}

StepperSettings stepper_settings_from(const json& object) {
  JsonObject keys(object, ErrorCode::bad_config, "turntable");
  StepperSettings settings;
  read_fields(keys, fields(settings));
  check_stepper_settings(keys, settings);
  keys.refuse_unread();
  return settings;
}

json to_json(const StepperSettings& settings) {
  StepperSettings copy = settings;
  return to_json(fields(copy));
}

Motion to_motion(const StepperSettings& settings) {
  const double steps = settings.full_steps * settings.microsteps * settings.gear_ratio;
  const double steps_per_deg = steps / 360;
  return {.steps_per_turn = static_cast<int>(std::lround(steps)),
          .steps_per_period = full_steps_per_period * settings.microsteps,
          .start_steps_per_second =
              std::min(settings.start_speed_deg_per_second * steps_per_deg, max_pulse_rate),
          .top_steps_per_second =
              std::min(settings.speed_deg_per_second * steps_per_deg, max_pulse_rate),
          .ramp_steps_per_second2 = settings.acceleration_deg_per_second2 * steps_per_deg,
          .settle_time = settings.settle_time};
}

std::vector<NamedLine> to_gpio_lines(const StepperSettings& settings) {
  std::vector<NamedLine> lines = {{.name = settings.lines.step, .high = false},
                                  {.name = settings.lines.direction, .high = false},
                                  {.name = settings.lines.enable, .high = true}};
  const std::vector<Microstepping> all = microsteppings(settings.driver);
  const auto levels = std::ranges::find(all, settings.microsteps, &Microstepping::microsteps);
  for (std::size_t line = 0; line < settings.lines.microsteps.size(); ++line) {
    lines.push_back(
        {.name = settings.lines.microsteps[line],
         .high = levels != all.end() && line < levels->levels.size() && levels->levels[line]});
  }
  return lines;
}

}  // namespace octurn
