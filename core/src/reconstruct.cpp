#include "octurn/reconstruct.hpp"

#include <cmath>
#include <memory>

#include "bennett/bennett_reconstructor.hpp"
#include "calibrate/platform_plane.hpp"
#include "laser/line_strip.hpp"
#include "octurn/error.hpp"
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

Eigen::Affine3d model_from_object(const ModelEdits& edits) {
  Eigen::Affine3d model_from_object = Eigen::Affine3d::Identity();
  model_from_object.scale(edits.scale);
  if (edits.lay) {
    // Near half a turn, rounding alone would choose the axis of the smallest rotation.
    const bool is_turned_over = edits.lay->down.z() > 1 - 1e-9;
    const Eigen::Quaterniond half_turn_about_x(0, 1, 0, 0);
    model_from_object.rotate(is_turned_over ? half_turn_about_x : rotation_to_z(-edits.lay->down));
    model_from_object.translation() = -model_from_object.linear() * edits.lay->point;
  }
  return model_from_object;
}

namespace {

/// @throws Error "bad-settings"
void expect_possible(const ModelEdits& edits) {
  const auto refuse = [](const char* what) { throw Error(ErrorCode::bad_settings, what); };
  const auto is_unit = [](const Eigen::Vector3d& v) { return std::abs(v.norm() - 1) < 1e-6; };
  for (const CutPlane& cut : edits.cuts) {
    if (!is_unit(cut.normal) || !std::isfinite(cut.distance)) {
      refuse("cuts: a normal must be of length one, and a distance finite");
    }
  }
  for (const ErasedBall& ball : edits.erased) {
    if (!ball.centre.allFinite() || !std::isfinite(ball.radius) || ball.radius <= 0) {
      refuse("erased: a centre must be finite, and a radius above 0");
    }
  }
  if (edits.lay && !(is_unit(edits.lay->down) && edits.lay->point.allFinite())) {
    refuse("lay: the direction must be of length one, and the point finite");
  }
  if (!std::isfinite(edits.scale) || edits.scale <= 0) {
    refuse("scale: must be above 0");
  }
}

}  // namespace

std::unique_ptr<Reconstructor> make_reconstructor(const ReconstructOptions& options) {
  expect_possible(options.edits);
  switch (options.method) {
    case Method::intersection:
      if (options.edits.change_shape() || options.solid.max_triangles) {
        throw Error(ErrorCode::bad_settings, "the method intersection cuts and erases nothing",
                    "Choose the method solid.");
      }
      return std::make_unique<BennettReconstructor>(options);
    case Method::solid:
      break;
  }
  return std::make_unique<SolidReconstructor>(options);
}

}  // namespace octurn
