#include <array>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <stop_token>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "commands/commands.hpp"
#include "commands/model_report.hpp"
#include "commands/reconstruct_input.hpp"
#include "mesh/mesh_formats.hpp"
#include "mesh/model_colours.hpp"
#include "octurn/error.hpp"
#include "octurn/file.hpp"
#include "octurn/model.hpp"
#include "octurn/quality.hpp"
#include "octurn/scan_folder.hpp"
#include "octurn/stl.hpp"
#include "octurn/tiles.hpp"
#include "octurn/units.hpp"
#include "progress_bar.hpp"
#include "settings/field.hpp"
#include "signal_stop.hpp"
#include "standard_output.hpp"
#include "store/job_json.hpp"
#include "store/stored_scan.hpp"

namespace octurn {
namespace {

/// Writes a model with colours in two steps: an STL beside the file, then the file itself.
class ColouredModel {
 public:
  /// @throws Error "bad-settings"    if the file's extension is not of a format with colours
  /// @throws Error "scan-malformed"  if the scan has no pictures
  ColouredModel(const std::filesystem::path& file, const Scan& scan);

  /// Removes the STL.
  ~ColouredModel();
  ColouredModel(const ColouredModel&) = delete;
  ColouredModel& operator=(const ColouredModel&) = delete;

  const std::filesystem::path& stl() const { return stl_; }

  /// Colours the finished STL and writes the file, which appears whole or not at all.
  /// @param folder  of the scan
  /// @throws Error "disk-full", "write-failed", "memory-limit"; Stopped
  void write(const std::filesystem::path& folder, const Scan& scan, const ModelEdits& edits,
             const std::stop_token& stop) const;

 private:
  std::filesystem::path file_;
  std::filesystem::path stl_;
  const MeshFormat& format_;
};

const MeshFormat& to_format(const std::filesystem::path& file) {
  const MeshFormat* const format = find_mesh_format(file.extension().string());
  if (format == nullptr) {
    throw Error(
        ErrorCode::bad_settings,
        file.string() + ": a model with colours is a file that ends with " + mesh_file_names(""),
        "An STL has no colours.");
  }
  return *format;
}

ColouredModel::ColouredModel(const std::filesystem::path& file, const Scan& scan)
    : file_(std::filesystem::absolute(file)),
      stl_(temporary_name(file_.string() + ".stl", 0)),
      format_(to_format(file)) {
  if (!scan.laser) {
    throw Error(ErrorCode::scan_malformed, "the scan has no pictures, and so no colours",
                "Only a scan by laser line has them.");
  }
}

ColouredModel::~ColouredModel() {
  std::error_code ignored;
  std::filesystem::remove(stl_, ignored);
}

void ColouredModel::write(const std::filesystem::path& folder, const Scan& scan,
                          const ModelEdits& edits, const std::stop_token& stop) const {
  const FacetFile facets(stl_);
  const std::vector<Rgb> colours = model_colours(facets, folder, scan, edits, stop);
  format_.write({.facets = facets, .name = file_.stem().string(), .colours = colours}, file_);
}

using Clock = std::chrono::steady_clock;
using Json = nlohmann::ordered_json;

/// Duration of each stage.
struct Times {
  Clock::duration snapshots = {};  ///< reading them and adding them to the reconstruction
  Clock::duration surface = {};    ///< extracting and writing it
};

double to_seconds(Clock::duration time) { return std::chrono::duration<double>(time).count(); }

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

/// The settings that the method uses; `clip_mm` is null for a scan without a clip box.
Json to_json(ModelSettings settings) {
  const Box& clip = settings.scan.clip;
  const bool is_clipped = clip.min != everywhere.min || clip.max != everywhere.max;
  Json object;
  for (const Field& field : fields(settings)) {
    if (field.method.empty() || field.method == to_string(settings.scan.method)) {
      object[std::string(field.key)] = field.access.write();
    }
  }
  if (!is_clipped) {
    object["clip_mm"] = nullptr;
  }
  return object;
}

/// @param quality    nothing for a model that is not judged
/// @param agreement  of a scan with free poses
Json to_json(const ModelReport& report, const std::optional<Quality>& quality,
             const std::optional<ViewAgreement>& agreement, const ModelSettings& settings,
             const Times& times) {
  const auto mm = [](const Eigen::Vector3d& metres) {
    return Json::array(
        {mm_from_metres(metres.x()), mm_from_metres(metres.y()), mm_from_metres(metres.z())});
  };
  Json object{{"leaves", report.leaves},
              {"triangles", report.triangles},
              {"bytes", report.bytes},
              {"watertight", report.watertight},
              {"volume_cm3", cm3_from_m3(report.volume)},
              {"size_mm", mm(report.size)}};
  if (settings.scan.method == Method::solid && agreement) {
    object["shell_thickness_mm"] =
        mm_from_metres(shell_thickness(reconstruct_options(settings.scan, settings.limits)));
  } else if (settings.scan.method == Method::solid) {
    object["parts"] = report.parts;
    object["dropped_parts"] = report.dropped.count;
    object["dropped_volume_cm3"] = cm3_from_m3(report.dropped.volume);
    object["seen_share"] = 1 - report.filled_share;
    object["filled_share"] = report.filled_share;
  }
  if (quality) {
    object["quality"] = to_json(*quality);
  }
  if (agreement) {
    object["views"] = {{"agreeing", agreement->agreeing},
                       {"contradicted", agreement->contradicted},
                       {"disagreement_mm", mm_from_metres(agreement->gap)}};
  }
  object["peak_memory_bytes"] = peak_memory_bytes();
  object["seconds"] = {{"snapshots", to_seconds(times.snapshots)},
                       {"surface", to_seconds(times.surface)},
                       {"total", to_seconds(times.snapshots + times.surface)}};
  object["settings"] = to_json(settings);
  return object;
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

/// The folder for temporary tiles, the model's own; empty for standard output.
std::filesystem::path spool_path(const std::filesystem::path& output) {
  if (output.empty() || output == "-") {
    return {};
  }
  return output.has_parent_path() ? output.parent_path() : std::filesystem::path(".");
}

/// Writes the surface. @param measured  whether it is measured on the way
std::optional<ModelReport> write_surface(Reconstructor& reconstructor,
                                         const SnapshotSource& snapshots,
                                         const std::filesystem::path& file, bool measured,
                                         const std::stop_token& stop) {
  ModelOutput output(file, [&] { return reconstructor.count(snapshots, stop).facets; });
  const auto write = [&](std::span<const Facet> facets) { output.write(facets); };
  std::optional<ModelReport> report;
  if (measured) {
    report = reconstructor.measured_surface(snapshots, write, stop);
    expect_facets(report->triangles);
  } else {
    expect_facets(reconstructor.surface(snapshots, write, stop).facets);
  }
  output.commit();
  return report;
}

}  // namespace

void reconstruct(const ReconstructArguments& arguments) try {
  const SignalStop signal;
  const std::stop_token stop = signal.token();
  auto [settings, input] = read_input(arguments);
  std::optional<ColouredModel> coloured;
  if (arguments.colour) {
    coloured.emplace(arguments.output, input.scan);
  }
  input.spool = spool_path(arguments.output);
  BuiltModel built;
  std::array<Clock::time_point, 3> begun{};  // of each step
  Times times;
  {
    ProgressBar bar;
    input.is_judged = arguments.json || bar.on_terminal();
    input.snapshots = [&](const Scan& scan) {
      return shown_snapshots(arguments.folder, scan, bar, stop);
    };
    input.progress = [&](BuildStep step, int done) {
      if (step == BuildStep::writing) {
        bar.show(done, done, "surface");
      }
      if (step == BuildStep::writing || done == 0) {
        begun[static_cast<std::size_t>(step)] = Clock::now();
      }
    };
    input.write = [&, measured = input.is_judged](Reconstructor& reconstructor,
                                                  const SnapshotSource& snapshots) {
      return write_surface(reconstructor, snapshots, coloured ? coloured->stl() : arguments.output,
                           measured, stop);
    };
    built = build_model(std::move(input), stop);
    if (coloured) {
      coloured->write(arguments.folder, built.scan, settings.edits.edits, stop);
    }
    times = {.snapshots = begun[2] - begun[1], .surface = Clock::now() - begun[2]};
  }
  if (built.quality) {
    print_verdict(*built.quality);
  }
  std::optional<ViewAgreement> agreement;
  if (built.report && has_free_poses(built.scan)) {
    agreement = compare_views(spread_views(stored_snapshots(arguments.folder, built.scan)));
    print_agreement(*agreement);
  }
  if (arguments.json) {
    print_report(arguments.output,
                 to_json(*built.report, built.quality, agreement, settings, times).dump());
  }
} catch (const Stopped&) {
  throw_stopped("no model was written");
}

}  // namespace octurn
