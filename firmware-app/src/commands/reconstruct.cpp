#include <sys/resource.h>

#include <chrono>
#include <iostream>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>

#include "commands/commands.hpp"
#include "interruption.hpp"
#include "octurn/error.hpp"
#include "octurn/mesh_report.hpp"
#include "octurn/scan_folder.hpp"
#include "octurn/stl.hpp"
#include "octurn/units.hpp"
#include "progress_bar.hpp"
#include "standard_output.hpp"

namespace octurn {
namespace {

using Clock = std::chrono::steady_clock;
using Json = nlohmann::ordered_json;

/// Time by stage.
struct Times {
  Clock::duration snapshots = {};  ///< reading and intersecting them
  Clock::duration surface = {};    ///< making and writing it
};

double seconds(Clock::duration time) { return std::chrono::duration<double>(time).count(); }

std::uint64_t peak_memory_bytes() {
  struct ::rusage usage {};
  ::getrusage(RUSAGE_SELF, &usage);
  return static_cast<std::uint64_t>(usage.ru_maxrss) * 1024;  // Linux counts in kilobytes
}

Box box_of(const std::array<double, 6>& mm) {
  const auto point = [&](std::size_t i) {
    return Eigen::Vector3d(metres_from_mm(mm[i]), metres_from_mm(mm[i + 1]),
                           metres_from_mm(mm[i + 2]));
  };
  return {.min = point(0), .max = point(3)};
}

/// @throws Error "bad-settings"  that names an option which the method does not have
void expect_options_of_method(const ReconstructArguments& arguments) {
  const auto refuse = [&](const char* option) {
    throw Error("bad-settings",
                std::string(option) + ": the method " + arguments.method + " has none");
  };
  if (arguments.method == "solid") {
    if (arguments.level) {
      refuse("--level");
    }
    if (arguments.threshold_m2) {
      refuse("--threshold-m2");
    }
  } else if (arguments.max_error_mm) {
    refuse("--max-error-mm");
  }
}

ReconstructOptions options_of(const ReconstructArguments& arguments, const Scan& scan) {
  expect_options_of_method(arguments);
  ReconstructOptions options{
      .method = method_named(arguments.method).value_or(Method::intersection),
      .clip = scan.clip,
      .level = arguments.level};
  if (arguments.max_error_mm) {
    options.target_error = metres_from_mm(*arguments.max_error_mm);
  }
  if (arguments.leaf_size_mm) {
    options.leaf_size = metres_from_mm(*arguments.leaf_size_mm);
  }
  if (arguments.root_size_mm) {
    options.root_size = metres_from_mm(*arguments.root_size_mm);
  }
  if (arguments.clip_mm) {
    options.clip = box_of(*arguments.clip_mm);
  }
  options.threshold = arguments.threshold_m2.value_or(options.threshold);
  options.threads = arguments.threads.value_or(available_threads());
  if (arguments.memory_limit_mb) {
    options.memory_limit = static_cast<std::size_t>(bytes_from_mb(*arguments.memory_limit_mb));
  }
  return options;
}

Json settings_of(const ReconstructOptions& options) {
  Json clip = Json::array();
  for (const Eigen::Vector3d& corner : {options.clip.min, options.clip.max}) {
    for (const double metres : corner) {
      clip.push_back(mm_from_metres(metres));
    }
  }
  const bool solid = options.method == Method::solid;
  Json settings{{"method", name_of(options.method)},
                {"leaf_size_mm", mm_from_metres(options.leaf_size)},
                {"root_size_mm", mm_from_metres(options.root_size)}};
  if (solid) {
    settings["max_error_mm"] = mm_from_metres(options.target_error);
  } else {
    settings["threshold_m2"] = options.threshold;
  }
  settings["clip_mm"] = clip;
  if (!solid) {
    settings["level"] = options.level ? Json(*options.level) : Json(nullptr);
  }
  settings["threads"] = options.threads;
  settings["memory_limit_mb"] = mb_from_bytes(static_cast<double>(options.memory_limit));
  return settings;
}

Json json_of(const ModelReport& report, const ReconstructOptions& options, const Times& times) {
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
  if (options.method == Method::solid) {
    json["parts"] = report.parts;
    json["seen_share"] = 1 - report.filled_share;
    json["filled_share"] = report.filled_share;
  }
  json["peak_memory_bytes"] = peak_memory_bytes();
  json["seconds"] = {{"snapshots", seconds(times.snapshots)},
                     {"surface", seconds(times.surface)},
                     {"total", seconds(times.snapshots + times.surface)}};
  json["settings"] = settings_of(options);
  return json;
}

/// Where the model goes: a file that appears whole or not at all, or standard output.
class ModelOutput {
 public:
  /// @param facets  counts them, which standard output needs to know before the first
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

/// The scan's snapshots; reading one shows how far it got. @throws Stopped  once `stop` is
/// requested
SnapshotSource snapshots_of(const std::filesystem::path& folder, const Scan& scan, ProgressBar& bar,
                            const std::stop_token& stop) {
  return {.count = scan.shots.size(),
          .read = [&bar, stored = stored_snapshots(folder, scan, stop)](std::size_t i) {
            bar.show(static_cast<int>(i), static_cast<int>(stored.count), "snapshots");
            return stored.read(i);
          }};
}

}  // namespace

void reconstruct(const ReconstructArguments& arguments) try {
  const Interruption interruption;
  const std::stop_token stop = interruption.token();
  const Scan scan = read_scan(arguments.folder);
  const ReconstructOptions options = options_of(arguments, scan);
  const std::unique_ptr<Reconstructor> reconstruction = make_reconstructor(options);
  MeshCheck check;
  std::optional<SurfaceCount> count;
  Times times;
  {
    ProgressBar bar;
    const SnapshotSource snapshots = snapshots_of(arguments.folder, scan, bar, stop);
    const Clock::time_point start = Clock::now();
    reconstruction->add(snapshots, stop);
    const Clock::time_point seen = Clock::now();
    bar.show(static_cast<int>(snapshots.count), static_cast<int>(snapshots.count), "surface");
    ModelOutput output(arguments.output,
                       [&] { return reconstruction->count(snapshots, stop).facets; });
    const auto checked = [&](std::span<const Facet> facets) {
      if (arguments.json) {
        check.add(facets);
      }
      output.write(facets);
    };
    count = write_model(*reconstruction, snapshots, checked, stop);
    if (!count) {
      throw Stopped{};
    }
    output.commit();
    times = {.snapshots = seen - start, .surface = Clock::now() - seen};
  }
  if (arguments.json) {
    // Where the model goes to standard output, a line of text does not belong into it.
    (arguments.output == "-" ? std::cerr : std::cout)
        << json_of(report_of(*count, check), options, times).dump() << std::endl;
  }
} catch (const Stopped&) {
  throw_stopped("no model was written");
}

}  // namespace octurn
