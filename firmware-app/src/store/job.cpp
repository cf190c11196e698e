#include "store/job.hpp"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <ctime>
#include <iterator>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>
#include <utility>

#include "octurn/error.hpp"
#include "octurn/file.hpp"
#include "one_line.hpp"
#include "settings/pose_field.hpp"
#include "wall_clock.hpp"

namespace octurn {
namespace {

using nlohmann::json;

Access optional_pose(std::optional<Eigen::Isometry3d>& value) {
  const json row{{"type", "array"}, {"items", {{"type", "number"}}}};
  return {.read =
              [&value](const JsonValue& given) {
                value = given.json().is_null() ? std::nullopt : std::optional(to_pose(given));
              },
          .write = [&value] { return value ? to_rows(*value) : json(); },
          .schema = {{"type", "array"}, {"items", row}}};
}

constexpr std::string_view id_form = "00000000-000000-xxxx";

}  // namespace

std::vector<Field> fields(BuildSettings& settings, const SettingRanges& ranges) {
  std::vector<Field> all = model_fields(settings.scan, ranges);
  all.push_back({.key = "level",
                 .help = "surface of a coarser level; 0 is the root",
                 .access = whole(settings.level, 0, max_levels),
                 .method = "intersection",
                 .default_text = "the leaves'"});
  all.push_back(
      {.key = "platform_from_sensor",
       .unit = "m",
       .help = "pose of the sensor, four rows of four numbers, in place of the configured one",
       .access = optional_pose(settings.platform_from_sensor),
       .default_text = "the scan's"});
  std::ranges::move(fields(settings.edits), std::back_inserter(all));
  return all;
}

json to_json(const BuildSettings& settings) {
  BuildSettings copy = settings;
  return to_json(fields(copy));
}

BuildSettings build_settings_from(const json& object, const BuildSettings& defaults) {
  JsonObject keys(object, ErrorCode::bad_settings, "");
  BuildSettings settings = defaults;
  read_fields(keys, fields(settings));
  check_leaf(keys, settings.scan);
  check_clip(keys, settings.scan);
  check_edits(keys, settings.edits, settings.scan.method);
  keys.refuse_unread();
  return settings;
}

BuildSettings stored_build_settings_from(const JsonValue& object) {
  JsonObject keys(object);
  BuildSettings settings;
  read_fields(keys, fields(settings, stored_ranges));
  keys.refuse_unread();
  return settings;
}

namespace {

template <typename Value>
using Names = std::pair<Value, std::string_view>;

constexpr std::array<Names<JobState>, 6> states{{{JobState::running, "running"},
                                                 {JobState::paused, "paused"},
                                                 {JobState::finished, "finished"},
                                                 {JobState::cancelled, "cancelled"},
                                                 {JobState::failed, "failed"},
                                                 {JobState::interrupted, "interrupted"}}};

constexpr std::array<Names<Phase>, 8> phases{{{Phase::starting, "starting"},
                                              {Phase::turning, "turning"},
                                              {Phase::capturing, "capturing"},
                                              {Phase::calibrating, "calibrating"},
                                              {Phase::rebuilding, "rebuilding"},
                                              {Phase::registering, "registering"},
                                              {Phase::building, "building"},
                                              {Phase::done, "done"}}};

template <typename Value, std::size_t size>
std::optional<Value> named(std::string_view name, const std::array<Names<Value>, size>& names) {
  const auto* found = std::ranges::find(names, name, &Names<Value>::second);
  return found == names.end() ? std::nullopt : std::optional(found->first);
}

}  // namespace

bool is_resumable(JobState state) {
  return state == JobState::paused || state == JobState::interrupted;
}

std::string_view to_string(JobState state) {
  return std::ranges::find(states, state, &Names<JobState>::first)->second;
}

std::string_view to_string(Phase phase) {
  return std::ranges::find(phases, phase, &Names<Phase>::first)->second;
}

std::optional<JobState> job_state_named(std::string_view name) { return named(name, states); }

std::optional<Phase> phase_named(std::string_view name) { return named(name, phases); }

Failure interruption() {
  return {.code = ErrorCode::interrupted,
          .detail = "the scanner was switched off during this scan",
          .hint = "Resume it if neither the object nor the platform was moved since."};
}

ScanCalibration to_scan_calibration(const CalibrationReport& report) {
  return {.accepted = report.accepted,
          .confirms_told = report.confirms_told(),
          .reason = report.reason,
          .solved = report.accepted ? std::optional(to_solved_pose(report)) : std::nullopt,
          .optics = report.optics,
          .findings = report.findings};
}

bool has_pose(const Build& build, const std::string& pose) {
  return std::ranges::find(build.poses, pose) != build.poses.end();
}

const Build* find_build(const Job& job, int number) {
  const auto found = std::ranges::find(job.builds.all, number, &Build::number);
  return found == job.builds.all.end() ? nullptr : &*found;
}

const Model* chosen_model(const Job& job) {
  if (const Build* const build = find_build(job, job.builds.chosen)) {
    return &build->model;
  }
  return job.model ? &*job.model : nullptr;
}

Job with_stored_changes(Job working, const Job& stored) {
  working.label = stored.label;
  working.builds.all = stored.builds.all;
  working.builds.chosen = stored.builds.chosen;
  return working;
}

Job to_interrupted(Job job, int snapshots, const Failure& reason) {
  job.state = JobState::interrupted;
  job.phase = Phase::done;
  job.snapshots_done = snapshots;
  job.times.left.reset();
  job.times.until_pause.reset();
  job.failure = reason;
  return job;
}

namespace {

namespace fs = std::filesystem;

constexpr std::size_t max_bytes = 16384;
constexpr std::ptrdiff_t max_line = 100;    // characters
constexpr std::ptrdiff_t max_notes = 2000;  // characters
constexpr std::ptrdiff_t max_tag = 40;      // characters
constexpr std::ptrdiff_t max_tags = 20;

/// Counts code points of UTF-8 text: all bytes but continuation bytes, which begin with bits 10.
std::ptrdiff_t count_characters(std::string_view text) {
  return std::ranges::count_if(
      text, [](char c) { return (static_cast<unsigned char>(c) & 0xC0U) != 0x80U; });
}

std::string read_text(const fs::path& file) {
  try {
    return read_regular_file(file, max_bytes).value_or("");
  } catch (const Error&) {
    return "";
  }
}

/// Whether text has no control characters except line feeds and tabs.
bool is_notes(const std::string& text) {
  std::string line = text;
  std::erase_if(line, [](char c) { return c == '\n' || c == '\t'; });
  return count_characters(text) <= max_notes && is_one_line(line);
}

/// Whether each line is a tag, and no tag comes twice.
bool are_tags(const std::string& text) {
  std::set<std::string> tags;
  std::ptrdiff_t count = 0;
  std::istringstream lines(text);
  for (std::string tag; std::getline(lines, tag); ++count) {
    const std::ptrdiff_t size = count_characters(tag);
    if (size == 0 || size > max_tag || !is_one_line(tag) || tag.find(',') != tag.npos ||
        !tags.insert(tag).second) {
      return false;
    }
  }
  return count <= max_tags;
}

}  // namespace

bool is_name(const std::string& text) {
  return count_characters(text) <= max_line && is_one_line(text);
}

std::span<const LabelText> label_texts() {
  constexpr std::string_view line = "text of at most 100 characters on one line";
  static constexpr std::array all{
      LabelText{"name", "name.txt", line, is_name, &ScanLabel::name, &LabelChange::name, false,
                true},
      LabelText{"notes", "notes.txt", "text of at most 2000 characters", is_notes,
                &ScanLabel::notes, &LabelChange::notes},
      LabelText{"tags", "tags.txt",
                "a list of at most 20 different texts of 1 to 40 characters on one line without "
                "commas",
                are_tags, &ScanLabel::tags, &LabelChange::tags, true},
      LabelText{"inventory_number", "inventory-number.txt", line, is_name,
                &ScanLabel::inventory_number, &LabelChange::inventory_number, false, true},
      LabelText{"author", "author.txt", line, is_name, &ScanLabel::author, &LabelChange::author,
                false, true},
      LabelText{"licence", "licence.txt", line, is_name, &ScanLabel::licence, &LabelChange::licence,
                false, true},
  };
  return all;
}

ScanLabel changed(ScanLabel label, const LabelChange& change) {
  for (const LabelText& text : label_texts()) {
    label.*text.text = (change.*text.change).value_or(label.*text.text);
  }
  return label;
}

ScanLabel read_label(const fs::path& folder) {
  ScanLabel label;
  for (const LabelText& text : label_texts()) {
    label.*text.text = read_text(folder / text.file);
  }
  return label;
}

void write_label(const fs::path& folder, const LabelChange& change) {
  for (const LabelText& text : label_texts()) {
    if (change.*text.change) {
      write_file(folder / text.file, *(change.*text.change));
    }
  }
}

bool is_scan_id(std::string_view text) {
  return std::ranges::equal(text, id_form, [](char c, char form) {
    const bool digit = c >= '0' && c <= '9';
    return form == '0' ? digit : form == 'x' ? digit || (c >= 'a' && c <= 'f') : c == form;
  });
}

std::string to_scan_id(ScanTime time) {
  auto fraction = (time - std::chrono::floor<std::chrono::seconds>(time)).count();
  std::string digits(4, '0');
  for (auto digit = digits.rbegin(); digit != digits.rend(); ++digit, fraction >>= 4) {
    *digit = "0123456789abcdef"[fraction & 0xf];
  }
  return utc_text(time, "%Y%m%d-%H%M%S-") + digits;
}

ScanTime to_time(const std::string& id) {
  std::tm utc{};
  const char* const fraction = ::strptime(id.c_str(), "%Y%m%d-%H%M%S-", &utc);
  return ScanTime(std::chrono::seconds(::timegm(&utc))) +
         ScanTime::duration(fraction == nullptr ? 0 : std::strtol(fraction, nullptr, 16));
}

}  // namespace octurn
