#include "commands/reconstruct_input.hpp"

#include <nlohmann/json.hpp>
#include <utility>

#include "commands/options.hpp"
#include "process.hpp"
#include "settings/field.hpp"
#include "store/scan_archive.hpp"

namespace octurn {
namespace {

ModelSettings settings_from(const nlohmann::json& given, const Scan& scan) {
  JsonObject keys(given, ErrorCode::bad_settings, "");
  const ReconstructOptions defaults = model_options(scan);
  ModelSettings settings{.scan = {.method = defaults.method,
                                  .leaf_size = defaults.leaf_size,
                                  .target_error = defaults.target_error,
                                  .clip = defaults.clip}};
  read_fields(keys, fields(settings));
  expect_options_of_method(given, fields(settings), to_string(settings.scan.method));
  check_leaf(keys, settings.scan);
  if (keys.value("clip_mm")) {
    check_clip(keys, settings.scan);
  }
  return settings;
}

ReconstructOptions options_from(const ModelSettings& settings) {
  ReconstructOptions options = reconstruct_options(settings.scan, settings.limits);
  options.level = settings.level;
  add_edits(options, settings.edits);
  return options;
}

void take_told_poses(Scan& scan) {
  scan.solved.reset();
  for (Shot& shot : scan.shots) {
    shot.slipped = 0;
  }
  for (ScanPose& pose : scan.poses) {
    pose.solved.reset();
  }
}

/// Reads the scan. The sensor map that the arguments name, if any, replaces its own.
Scan read_scan_of(const ReconstructArguments& arguments) {
  Scan scan = read_scan(arguments.folder);
  if (arguments.sensor_map) {
    use_sensor_map(scan, *arguments.sensor_map);
  }
  return scan;
}

/// Checks that the model does not replace a file of its scan.
void expect_no_input(const std::filesystem::path& output, const std::filesystem::path& scan) {
  const auto inside = std::filesystem::weakly_canonical(output).lexically_relative(
      std::filesystem::weakly_canonical(scan));
  if (is_scan_file(inside.generic_string())) {
    throw Error(ErrorCode::bad_settings,
                "--output is " + output.string() + ": must not be a file of the scan itself");
  }
}

}  // namespace

ReconstructInput read_input(const ReconstructArguments& arguments) {
  if (!arguments.output.empty()) {
    expect_no_input(arguments.output, arguments.folder);
    expect_writable(arguments.output);
  }
  Scan scan = read_scan_of(arguments);
  ReconstructInput input{.settings = settings_from(arguments.settings, scan)};
  const ModelSettings& settings = input.settings;
  if (settings.scan.pose == PoseSource::configured) {
    take_told_poses(scan);
  }
  input.model = {.folder = arguments.folder,
                 .scan = std::move(scan),
                 .options = options_from(settings),
                 .solves_pose = settings.scan.pose == PoseSource::solved};
  if (settings.limits.memory_bytes != 0) {
    return_freed_memory();
  } else {
    keep_freed_memory();
  }
  return input;
}

SnapshotSource shown_snapshots(const std::filesystem::path& folder, const Scan& scan,
                               ProgressBar& bar, const std::stop_token& stop) {
  return {.count = scan.shots.size(),
          .read = [&bar, stored = stored_snapshots(folder, scan, stop)](std::size_t i) {
            bar.show(static_cast<int>(i), static_cast<int>(stored.count), "snapshots");
            return stored.read(i);
          }};
}

}  // namespace octurn
