#include <chrono>
#include <fstream>
#include <iostream>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "commands/commands.hpp"
#include "commands/options.hpp"
#include "octurn/error.hpp"
#include "octurn/mesh_report.hpp"
#include "octurn/quality.hpp"
#include "octurn/scan_folder.hpp"
#include "octurn/stl.hpp"
#include "octurn/units.hpp"
#include "process_memory.hpp"
#include "progress_bar.hpp"
#include "scan/checked_snapshots.hpp"
#include "scan/last_look.hpp"
#include "scan/quality_json.hpp"
#include "scan/solve_pose.hpp"
#include "settings/field.hpp"
#include "signal_stop.hpp"
#include "standard_output.hpp"

namespace octurn {
namespace {

using Clock = std::chrono::steady_clock;
using Json = nlohmann::ordered_json;

/// Duration of each stage.
struct Times {
  Clock::duration snapshots = {};  ///< reading and intersecting them
  Clock::duration surface = {};    ///< making and writing it
};

double seconds(Clock::duration time) { return std::chrono::duration<double>(time).count(); }

/// Peak resident memory of this process, bytes. VmHWM, because ru_maxrss includes the parent's
/// memory from before exec.
std::uint64_t peak_memory_bytes() {
  std::ifstream status("/proc/self/status");
  for (std::string key; status >> key;) {
    if (key == "VmHWM:") {
      double kb = 0;
      status >> kb;
      return static_cast<std::uint64_t>(bytes_from_kb(kb));
    }
  }
  return 0;
}

ModelSettings settings_from(const nlohmann::json& given, const Scan& scan) {
  JsonObject keys(given, ErrorCode::bad_settings, "");
  ModelSettings settings;
  if (scan.laser) {
    use_laser_defaults(settings.scan);
  }
  read_fields(keys, fields(settings));
  expect_options_of_method(given, fields(settings), to_string(settings.scan.method));
  check_leaf(keys, settings.scan);
  if (keys.value("clip_mm")) {
    check_clip(keys, settings.scan);
  }
  return settings;
}

ReconstructOptions options_from(const ModelSettings& settings, const Scan& scan) {
  ReconstructOptions options = reconstruct_options(settings.scan, settings.limits);
  options.level = settings.level;
  options.placements = placements(scan);
  fit_to_sensor(options, scan);
  return options;
}

/// The settings that the method uses.
Json to_json(ModelSettings settings) {
  Json json;
  for (const Field& field : fields(settings)) {
    if (field.method.empty() || field.method == to_string(settings.scan.method)) {
      json[std::string(field.key)] = field.access.write();
    }
  }
  return json;
}

/// One line for people, if the model is not good.
std::string to_text(const Quality& quality) {
  std::string text = quality.verdict == Verdict::bad ? "The model is bad: " : "Look at the model: ";
  for (const QualityReason& reason : quality.reasons) {
    text += (&reason == quality.reasons.data() ? "" : "; ") + reason.detail;
  }
  return text + ".\n";
}

Json to_json(const ModelReport& report, const Quality& quality, const ModelSettings& settings,
             const Times& times) {
  const auto mm = [](const Eigen::Vector3d& metres) {
    return Json::array(
        {mm_from_metres(metres.x()), mm_from_metres(metres.y()), mm_from_metres(metres.z())});
  };
  Json json{{"leaves", report.leaves},
            {"triangles", report.triangles},
            {"bytes", report.bytes},
            {"watertight", report.watertight},
            {"volume_cm3", cm3_from_m3(report.volume)},
            {"size_mm", mm(report.size)}};
  if (settings.scan.method == Method::solid) {
    json["parts"] = report.parts;
    json["dropped_parts"] = report.dropped.count;
    json["dropped_volume_cm3"] = cm3_from_m3(report.dropped.volume);
    json["seen_share"] = 1 - report.filled_share;
    json["filled_share"] = report.filled_share;
  }
  json["quality"] = to_json(quality);
  json["peak_memory_bytes"] = peak_memory_bytes();
  json["seconds"] = {{"snapshots", seconds(times.snapshots)},
                     {"surface", seconds(times.surface)},
                     {"total", seconds(times.snapshots + times.surface)}};
  json["settings"] = to_json(settings);
  return json;
}

/// Destination of the model: standard output, or a file that appears whole or not at all.
class ModelOutput {
 public:
  /// @param facets  counts the facets; called for standard output, whose header needs the number
  template <typename CountFacets>
  ModelOutput(const std::filesystem::path& output, CountFacets facets) {
    if (output != "-") {
      file_.emplace(output);
    } else if (const std::uint64_t count = facets(); count > 0) {
      write_standard_output(stl_header(count));
    }
  }

  void write(std::span<const Facet> facets) {
    if (file_) {
      file_->write(facets);
    } else {
      write_standard_output(std::as_bytes(facets));
    }
  }

  void commit() {
    if (file_) {
      file_->commit();
    }
  }

 private:
  std::optional<StlFile> file_ = {};
};

/// The scan's snapshots. Reading one updates the progress bar, and throws Stopped once `stop` is
/// requested.
SnapshotSource shown_snapshots(const std::filesystem::path& folder, const Scan& scan,
                               ProgressBar& bar, const std::stop_token& stop) {
  return {.count = scan.shots.size(),
          .read = [&bar, stored = stored_snapshots(folder, scan, stop)](std::size_t i) {
            bar.show(static_cast<int>(i), static_cast<int>(stored.count), "snapshots");
            return stored.read(i);
          }};
}

/// A scan with the pose that its model is made with, and what solving it and its last look found.
struct PosedScan {
  Scan scan = {};
  std::vector<CalibrationFinding> findings = {};
};

void take_told_poses(Scan& scan) {
  scan.solved.reset();
  for (ScanPose& pose : scan.poses) {
    pose.solved.reset();
  }
}

/// A solved pose that merely confirms the told one does not replace it: the model keeps its bytes.
PosedScan with_pose(Scan scan, const std::filesystem::path& folder, const ModelSettings& settings,
                    const std::stop_token& stop) {
  PosedScan posed{.scan = std::move(scan)};
  if (settings.scan.pose == PoseSource::told) {
    take_told_poses(posed.scan);
  } else if (!posed.scan.solved && is_one_turn(posed.scan)) {
    ScanSolution solution =
        solve_scan(folder, posed.scan, stored_snapshots(folder, posed.scan, stop),
                   settings.limits.threads, stop);
    if (solution.replaces_told) {
      posed.scan.solved = std::move(solution.solved);
    }
    posed.findings = std::move(solution.report.findings);
  }
  add_stored_move(folder, posed.findings);
  return posed;
}

/// The scan, to be read with the sensor map that the arguments name, else with its own.
Scan read_scan_of(const ReconstructArguments& arguments) {
  Scan scan = read_scan(arguments.folder);
  if (arguments.sensor_map) {
    use_sensor_map(scan, *arguments.sensor_map);
  }
  return scan;
}

}  // namespace

void reconstruct(const ReconstructArguments& arguments) try {
  const SignalStop signal;
  const std::stop_token stop = signal.token();
  Scan told = read_scan_of(arguments);
  ModelSettings settings = settings_from(arguments.settings, told);
  expect_writable(arguments.output);
  const auto [scan, findings] = with_pose(std::move(told), arguments.folder, settings, stop);
  if (!arguments.settings.contains("clip_mm")) {
    settings.scan.clip = model_clip(scan);
  }
  const ReconstructOptions options = options_from(settings, scan);
  if (options.memory_limit != 0) {
    return_freed_memory();
  }
  const std::unique_ptr<Reconstructor> reconstruction = make_reconstructor(options);
  PoseChecks scan_checks(options.placements, options.clip, scan.shots.size());
  MeshCheck check;
  std::optional<SurfaceCount> count;
  Times times;
  {
    ProgressBar bar;
    const SnapshotSource snapshots =
        checked_snapshots(shown_snapshots(arguments.folder, scan, bar, stop), scan_checks);
    const Clock::time_point start = Clock::now();
    reconstruction->add(snapshots, stop);
    const Clock::time_point seen = Clock::now();
    bar.show(static_cast<int>(snapshots.count), static_cast<int>(snapshots.count), "surface");
    ModelOutput output(arguments.output,
                       [&] { return reconstruction->count(snapshots, stop).facets; });
    const auto checked = [&](std::span<const Facet> facets) {
      check.add(facets);
      output.write(facets);
    };
    count = write_model(*reconstruction, snapshots, checked, stop);
    if (!count) {
      throw Stopped{};
    }
    output.commit();
    times = {.snapshots = seen - start, .surface = Clock::now() - seen};
  }
  const ModelReport report = report_of(*count, check);
  const Quality quality = judge(scan_checks.figures(options.threads), report, findings);
  if (quality.verdict != Verdict::good) {
    std::cerr << to_text(quality);
  }
  if (arguments.json) {
    const std::string line = to_json(report, quality, settings, times).dump() + "\n";
    if (arguments.output == "-") {
      std::cerr << line;  // a line of text does not belong into the model
    } else {
      write_standard_output(line);
    }
  }
} catch (const Stopped&) {
  throw_stopped("no model was written");
}

}  // namespace octurn
