#include <algorithm>
#include <cmath>
#include <sstream>
#include <string>
#include <vector>

#include "io/radial_distortion.hpp"
#include "lens/grey_image.hpp"
#include "lens/lens_solver.hpp"
#include "octurn/intrinsics_json.hpp"
#include "octurn/lens.hpp"
#include "octurn/units.hpp"

namespace octurn {
namespace {

constexpr std::size_t min_views = 5;
constexpr std::size_t min_view_corners = 12;  // of a view: three by four
constexpr double min_tilt_deg = 20;           // between two boards
constexpr double max_focal_sigma = 0.003;     // of the focal length
constexpr double min_coverage = 0.85;

std::string number(double value, int digits) {
  std::ostringstream text;
  text.setf(std::ios::fixed);
  text.precision(digits);
  text << value;
  return text.str();
}

/// The largest angle between the normals of two boards, radians.
double largest_tilt(const std::vector<Eigen::Isometry3d>& boards) {
  double least = 1;
  for (const Eigen::Isometry3d& one : boards) {
    for (const Eigen::Isometry3d& other : boards) {
      least = std::min(least, one.linear().col(2).dot(other.linear().col(2)));
    }
  }
  return std::acos(std::clamp(least, -1.0, 1.0));
}

CameraLens to_lens(const LensNumbers& numbers, int width, int height) {
  return {.intrinsics = {.width = width,
                         .height = height,
                         .fx = numbers[0],
                         .fy = numbers[1],
                         .cx = numbers[2],
                         .cy = numbers[3]},
          .k1 = numbers[4],
          .k2 = numbers[5]};
}

/// Whether the distortion maps rays to pixels one-to-one within the picture.
bool is_one_to_one(const CameraLens& lens) {
  const Intrinsics& in = lens.intrinsics;
  const double across = std::max(in.cx, in.width - 1 - in.cx) / in.fx;
  const double down = std::max(in.cy, in.height - 1 - in.cy) / in.fy;
  return RadialDistortion{.k1 = lens.k1, .k2 = lens.k2}.is_invertible_to(std::hypot(across, down));
}

double covered_share(const LensCoverage& coverage) {
  return static_cast<double>(std::ranges::count(coverage, true)) /
         static_cast<double>(coverage.size());
}

/// Returns why a lens is refused; empty if it is accepted.
/// @param max_rms  pixels, at the usual width
std::string find_fault(const LensReport& report, double max_rms) {
  const double focal_sigma = std::max(report.sigma.intrinsics.fx / report.lens.intrinsics.fx,
                                      report.sigma.intrinsics.fy / report.lens.intrinsics.fy);
  const double tilt_deg = degrees_from_radians(report.tilt);
  if (tilt_deg < min_tilt_deg) {
    return "the board was held nearly parallel in all pictures, within " + number(tilt_deg, 0) +
           " degrees: only a tilted board shows the focal length";
  }
  if (const double share = covered_share(report.coverage); share < min_coverage) {
    return "the board was shown in " + number(100 * share, 0) +
           " % of the picture only: a lens distorts most at the edges";
  }
  if (report.rms > max_rms * std::max(1.0, report.lens.intrinsics.width / double{usual_width})) {
    return "the corners lie " + number(report.rms, 2) +
           " pixels from where a lens would show them: the board was not flat, or it moved";
  }
  if (!(focal_sigma < max_focal_sigma)) {
    return "the pictures determine the focal length to " + number(100 * focal_sigma, 1) +
           " % only: tilt the board more";
  }
  if (!(std::max(std::abs(report.lens.k1), std::abs(report.lens.k2)) <= max_distortion)) {
    return "the distortion that was found is impossible: no lens bends a picture that much";
  }
  return is_one_to_one(report.lens)
             ? ""
             : "the distortion that was found is impossible: it folds the picture over";
}

/// Whether a view's corners determine a homography well: at least 12, over three rows and columns.
bool is_usable(const BoardView& view) {
  if (view.size() < min_view_corners) {
    return false;
  }
  const auto [left, right] = std::ranges::minmax(view, {}, &BoardCorner::column);
  const auto [top, bottom] = std::ranges::minmax(view, {}, &BoardCorner::row);
  return right.column - left.column >= 2 && bottom.row - top.row >= 2;
}

}  // namespace

void add_view(LensCoverage& coverage, const BoardView& view, int width, int height) {
  const auto cell = [](double pixel, int pixels) {
    const double share = (pixel + 0.5) / pixels;
    return static_cast<std::size_t>(
        std::clamp(static_cast<int>(share * lens_cells), 0, lens_cells - 1));
  };
  for (const BoardCorner& corner : view) {
    coverage[cell(corner.pixel.y(), height) * lens_cells + cell(corner.pixel.x(), width)] = true;
  }
}

LensReport calibrate_lens(std::span<const BoardView> views, int width, int height,
                          const LensRules& rules) {
  std::vector<BoardView> used;
  LensReport report;
  for (std::size_t i = 0; i < views.size(); ++i) {
    if (is_usable(views[i])) {
      used.push_back(views[i]);
      report.boards.push_back({.view = i});
      add_view(report.coverage, views[i], width, height);
    }
  }
  report.views = static_cast<int>(used.size());
  if (used.size() < min_views) {
    report.reason = "a board was seen in " + std::to_string(used.size()) + " pictures: at least " +
                    std::to_string(min_views) + " have to show it";
    return report;
  }
  LensFit fit = fit_lens(used, first_lens(used, width, height), rules.shape);
  drop_outliers(used, fit.found);
  fit = fit_lens(used, fit.found, rules.shape);
  for (std::size_t i = 0; i < used.size(); ++i) {
    report.corners += static_cast<int>(used[i].size());
    report.boards[i].camera_from_board = fit.found.camera_from_board[i];
  }
  report.lens = to_lens(fit.found.lens, width, height);
  report.sigma = to_lens(fit.sigma, width, height);
  report.rms = fit.rms;
  report.tilt = largest_tilt(fit.found.camera_from_board);
  report.reason = find_fault(report, rules.max_rms);
  report.accepted = report.reason.empty();
  return report;
}

}  // namespace octurn
