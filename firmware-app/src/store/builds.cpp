#include "store/builds.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <limits>
#include <nlohmann/json.hpp>

#include "log.hpp"
#include "octurn/file.hpp"
#include "store/data_folder.hpp"
#include "store/job_json.hpp"

namespace octurn {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr std::size_t max_build_bytes = std::size_t{1} << 20U;  // 100 times the usual size

}  // namespace

int to_build_number(const std::string& name) {
  int number = 0;
  const char* const end = name.data() + name.size();
  const auto read = std::from_chars(name.data(), end, number);
  const bool is_number = read.ec == std::errc() && read.ptr == end && number > 0;
  return is_number && name == std::to_string(number) ? number : 0;
}

Build read_build(const fs::path& folder, int number) {
  const json document =
      parse_json(read_regular_file(folder / "build.json", max_build_bytes).value_or(""),
                 ErrorCode::job_malformed, "the file");
  JsonObject keys(document, ErrorCode::job_malformed, "");
  const JsonValue calibration = keys.at("calibration");
  Build build{
      .number = number,
      .created = keys.at("created").text(),
      .settings = stored_build_settings_from(keys.at("settings")),
      .model = to_model(keys.at("model")),
      .replaced = keys.whole_number("replaced", 0, std::numeric_limits<int>::max()).value_or(0)};
  if (const auto poses = keys.value("poses")) {
    for (const JsonValue& scan : poses->elements()) {
      build.poses.push_back(scan.text());
    }
  }
  if (!calibration.json().is_null()) {
    build.calibration = to_scan_calibration(calibration);
  }
  return build;
}

void write_build(const fs::path& folder, const Build& build) {
  const json document{{"created", build.created},
                      {"settings", to_json(build.settings)},
                      {"calibration", build.calibration ? to_json(*build.calibration) : json()},
                      {"model", to_json(build.model)},
                      {"poses", build.poses},
                      {"replaced", build.replaced}};
  write_file(folder / "build.json",
             document.dump(1, ' ', false, json::error_handler_t::replace) + "\n");
}

std::vector<Build> read_builds(const fs::path& scan) {
  std::vector<Build> builds;
  for (const std::string& name : names_in(scan / builds_folder)) {
    const fs::path folder = scan / builds_folder / name;
    const int number = to_build_number(name);
    std::error_code unknown;
    if (number == 0 ||
        (fs::exists(folder / task_file, unknown) && !fs::exists(folder / "build.json", unknown))) {
      continue;
    }
    try {
      builds.push_back(read_build(folder, number));
    } catch (...) {
      log::warning("store", folder.string() + ": build.json: " + current_failure().detail);
    }
  }
  std::ranges::sort(builds, {}, &Build::number);
  return builds;
}

int next_build_number(const fs::path& scan) {
  int highest = 0;
  for (const std::string& name : names_in(scan / builds_folder)) {
    highest = std::max(highest, to_build_number(name));
  }
  return highest + 1;
}

Failure displaced_by_scan() {
  return {.code = ErrorCode::busy,
          .detail = "a scan has started",
          .hint = "Build again when it has ended."};
}

std::string describe(const BuildRun& run) {
  return "build " + std::to_string(run.number) + " of scan " + run.scan;
}

std::string_view to_string(BuildRun::State state) {
  constexpr std::array<std::string_view, 5> names{"waiting", "running", "finished", "failed",
                                                  "cancelled"};
  return names[static_cast<std::size_t>(state)];
}

}  // namespace octurn
