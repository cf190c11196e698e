#include "calibrate/surface_findings.hpp"

#include <algorithm>
#include <utility>

#include "calibrate/platform_map.hpp"
#include "calibrate/platform_wobble.hpp"
#include "calibrate/stop_planes.hpp"
#include "io/number_text.hpp"
#include "octurn/units.hpp"

namespace octurn {
namespace {

constexpr double bad_wobble_sigmas = 5;
constexpr double min_wobble_deg = 0.3;
constexpr int wobble_digits = 2;  // of degrees

/// Adds the finding "wobble" if the platform tilts as it turns.
void add_wobble(CalibrationReport& report, const std::optional<PlatformWobble>& wobble) {
  if (wobble && wobble->angle > std::max(radians_from_degrees(min_wobble_deg),
                                         bad_wobble_sigmas * wobble->sigma)) {
    report.findings.push_back(
        {.code = "wobble",
         .detail = "the platform's surface tilts by " + degrees_text(wobble->angle, wobble_digits) +
                   " as it turns",
         .hint = "Look whether the platform sits straight on the motor.",
         .parameters = {{"wobble_deg", degrees_from_radians(wobble->angle)}}});
  }
}

}  // namespace

SurfaceFindings look_at_surface(CalibrationReport& report, const PlatformSamples& samples,
                                const PlatformPlane& plane, const std::vector<double>& angles,
                                const Eigen::Isometry3d& levelled) {
  const std::vector<bool> is_plane = find_plane_pixels(samples, plane);
  const std::vector<StopPlane> planes = measure_stop_planes(samples, plane, is_plane, levelled);
  SurfaceFindings surface{.unevenness = measure_platform_map(samples, plane, is_plane)};
  const auto step = solve_sensor_step(planes, angles);
  if (auto bump = step ? find_bump(*step) : std::nullopt) {
    report.findings = {*std::move(bump)};  // which looks like a slip, or a move of the object
    surface.bump = step;
  }
  add_wobble(report, measure_wobble(planes, angles));
  return surface;
}

void add_no_map(CalibrationReport& report, double unevenness) {
  report.findings.push_back(
      {.code = "no-map",
       .detail = "the flat platform looks uneven by " +
                 number_text("%.2f units of the sensor's disparity", unevenness),
       .hint =
           "Make the sensor's map from a bare wall: models become up to four times more accurate.",
       .parameters = {{"unevenness_disparity", unevenness}}});
}

}  // namespace octurn
