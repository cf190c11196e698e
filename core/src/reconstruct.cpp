#include "octurn/reconstruct.hpp"

#include <memory>

#include "bennett/bennett_reconstructor.hpp"
#include "laser/line_strip.hpp"
#include "octurn/scan_folder.hpp"
#include "tsdf/solid_reconstructor.hpp"

namespace octurn {

void fit_to_scan(ReconstructOptions& options, const Scan& scan) {
  options.placements = placements(scan);
  options.solid.truncation = sensor_traits(scan).truncation;
  if (scan.laser) {
    options.program_memory += LaserLines::expected_bytes(scan);
  }
}

ReconstructOptions model_options(const Scan& scan) {
  ReconstructOptions options{
      .method = has_free_poses(scan) ? Method::intersection : Method::solid,
      .leaf_size = sensor_traits(scan).leaf_size,
      .clip = model_clip(scan),
      .target_error = sensor_traits(scan).target_error,
  };
  fit_to_scan(options, scan);
  return options;
}

SnapshotSource stored_snapshots(const std::filesystem::path& folder, const Scan& scan,
                                const std::stop_token& stop) {
  if (scan.laser) {
    return {
        .count = scan.shots.size(),
        .read = [stop, lines = std::make_shared<const LaserLines>(folder, scan)](std::size_t i) {
          throw_if_stopped(stop);
          return lines->snapshot(i);
        }};
  }
  return {.count = scan.shots.size(), .read = [=](std::size_t i) {
            throw_if_stopped(stop);
            return read_snapshot(folder, scan, scan.shots[i]);
          }};
}

std::string_view to_string(Method method) {
  return method == Method::solid ? "solid" : "intersection";
}

std::optional<Method> method_named(std::string_view name) {
  for (const Method method : {Method::intersection, Method::solid}) {
    if (to_string(method) == name) {
      return method;
    }
  }
  return std::nullopt;
}

std::string_view to_string(Parts parts) { return parts == Parts::main ? "main" : "all"; }

std::unique_ptr<Reconstructor> make_reconstructor(const ReconstructOptions& options) {
  switch (options.method) {
    case Method::intersection:
      return std::make_unique<BennettReconstructor>(options);
    case Method::solid:
      break;
  }
  return std::make_unique<SolidReconstructor>(options);
}

}  // namespace octurn
