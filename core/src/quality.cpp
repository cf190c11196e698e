#include "octurn/quality.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "calibrate/missing_part.hpp"
#include "calibrate/object_view.hpp"
#include "io/number_text.hpp"
#include "octurn/units.hpp"

namespace octurn {
namespace {

constexpr double min_volume = 1e-7;  // cubic metres

// Two stops of a correct rig disagree by 0.5 to 0.7 mm at 0.65 m with a Kinect v1, whose noise
// grows with the square of the distance.
constexpr double noise_distance = 0.65;       // metres
constexpr double look_disagreement = 0.0011;  // metres
constexpr double bad_disagreement = 0.0022;
constexpr double max_contradicted = 0.1;  // of a stop's readings

constexpr double look_height = 0.0025;  // metres between the platform and z = 0
constexpr double bad_height = 0.008;

constexpr double look_gap_deg = 100;  // between neighbouring stops: each sees 60 degrees to a side
constexpr double bad_gap_deg = 170;
constexpr double look_unseen = 0.25;  // of the surface above the base
constexpr double bad_unseen = 0.5;

constexpr const char* unseen_hint =
    "Dull what is black, shiny or clear with chalk or dry shampoo; lay the object another way, and "
    "scan it again.";

constexpr double max_fill = 0.03;  // metres from anything that was seen

constexpr double max_cut_pixels = 6;  // a depth image: 7 mm at 0.65 m
constexpr double max_dropped = 0.01;  // of the model's volume
constexpr double min_dropped = 2e-7;  // cubic metres

constexpr int text_digits = 1;  // of millimetres

// Metres, sigma of the distance between two opposite surfaces of a model: noise and what a map
// leaves of the sensor's pattern. Without a map the pattern of 0.8 units of disparity remains.
constexpr double mapped_surface_sigma = 0.00012;
constexpr double unmapped_surface_sigma = 0.0003;
constexpr double data_sheet_focal_sigma = 0.015;  // relative, of published units
constexpr double stated_sigmas = 2;

/// Relative sigma of the focal length with which a pose's snapshots are read.
/// @param seen  as measured from the snapshots, also where it was not applied
double focal_sigma(const Scan& scan, const std::optional<SolvedPose>& solved,
                   const std::optional<SolvedOptics>& seen) {
  const auto& optics = solved && solved->optics ? solved->optics : scan.optics;
  const double used = optics ? optics->value.fx : scan.intrinsics.fx;
  if (seen) {
    return std::hypot(seen->sigma.fx, seen->value.fx - used) / used;
  }
  return optics && optics->sigma.fx > 0 ? optics->sigma.fx / used : data_sheet_focal_sigma;
}

/// Collects reasons; the worst of them is the verdict.
class Judgement {
 public:
  void add(Verdict verdict, QualityReason reason) {
    quality_.verdict = std::max(quality_.verdict, verdict);
    quality_.reasons.push_back(std::move(reason));
  }
  Quality take() { return std::move(quality_); }

 private:
  Quality quality_ = {};
};

void judge_agreement(Judgement& judgement, const ScanFigures& scan) {
  const double scale = std::pow(std::max(scan.distance, noise_distance) / noise_distance, 2);
  if (scan.disagreement > look_disagreement * scale) {
    judgement.add(scan.disagreement > bad_disagreement * scale ? Verdict::bad : Verdict::look,
                  {.code = "stops-disagree",
                   .detail = "two stops disagree about the object by " +
                             mm_text(scan.disagreement, text_digits),
                   .hint = "Calibrate the rig, and check that object and sensor stand firm.",
                   .parameters = {{"disagreement_mm", mm_from_metres(scan.disagreement)}},
                   .places = scan.disagreeing_places});
  }
  const auto odd = std::ranges::max_element(scan.contradicted);
  if (odd != scan.contradicted.end() && *odd > max_contradicted) {
    judgement.add(
        Verdict::look,
        {.code = "moved",
         .detail = "at stop " + std::to_string(odd - scan.contradicted.begin()) + " " +
                   percent_text(*odd) + " of what was seen lies where other stops saw empty space",
         .hint = "Keep hands out of the picture, and check that nothing moves.",
         .parameters = {{"stop", static_cast<double>(odd - scan.contradicted.begin())},
                        {"empty_share", *odd}},
         .places = scan.contradicted_places});
  }
}

void judge_findings(Judgement& judgement, std::span<const CalibrationFinding> findings) {
  for (const CalibrationFinding& finding : findings) {
    if (finding.code == "moved" || finding.code == "focal-length" || finding.code == "optics") {
      judgement.add(Verdict::look, {.code = finding.code,
                                    .detail = finding.detail,
                                    .hint = finding.hint,
                                    .parameters = finding.parameters});
    } else if (finding.code == "slip" || finding.code == "turn-not-whole" ||
               finding.code == "still" || finding.code == "stops-disagree") {
      judgement.add(finding.code == "still" ? Verdict::bad : Verdict::look,
                    {.code = "stops-disagree",
                     .detail = finding.detail,
                     .hint = finding.hint,
                     .parameters = finding.parameters});
    }
  }
}

void judge_height(Judgement& judgement, const ScanFigures& scan, const ModelReport& model) {
  const double platform = scan.platform_height.value_or(0);
  if (platform > look_height) {
    judgement.add(platform > bad_height ? Verdict::bad : Verdict::look,
                  {.code = "floats",
                   .detail = "the platform is seen " + mm_text(platform, text_digits) +
                             " above where it should be, and becomes a part of the model",
                   .hint = "Calibrate the rig.",
                   .parameters = {{"platform_above_mm", mm_from_metres(platform)}}});
  } else if (-platform > look_height) {
    judgement.add(-platform > bad_height ? Verdict::bad : Verdict::look,
                  {.code = "sunk",
                   .detail = "the platform is seen " + mm_text(-platform, text_digits) +
                             " below where it should be, and as much of the object is missing",
                   .hint = "Calibrate the rig.",
                   .parameters = {{"platform_below_mm", mm_from_metres(-platform)}}});
  } else if (model.parts > 0 && model.bottom > bad_height) {  // a hollow shell may end anywhere
    judgement.add(
        Verdict::look,
        {.code = "floats",
         .detail = "the model begins " + mm_text(model.bottom, text_digits) + " above the platform",
         .hint = "Look whether the box reaches down to the platform.",
         .parameters = {{"bottom_mm", mm_from_metres(model.bottom)}}});
  }
}

void judge_coverage(Judgement& judgement, const ScanFigures& scan, const ModelReport& model) {
  if (scan.widest_gap > radians_from_degrees(look_gap_deg)) {
    judgement.add(
        scan.widest_gap > radians_from_degrees(bad_gap_deg) ? Verdict::bad : Verdict::look,
        {.code = "little-seen",
         .detail = "the platform turned by " + degrees_text(scan.widest_gap, 0) +
                   " without a stop: nobody saw that side of the object",
         .hint = "Scan a whole turn.",
         .parameters = {{"gap_deg", degrees_from_radians(scan.widest_gap)}},
         .places = model.places.unseen});
  } else if (model.unseen_share > look_unseen) {
    judgement.add(model.unseen_share > bad_unseen ? Verdict::bad : Verdict::look,
                  {.code = "little-seen",
                   .detail = percent_text(model.unseen_share) +
                             " of the surface above the base was not seen, and is filled in",
                   .hint = unseen_hint,
                   .parameters = {{"unseen_share", model.unseen_share}},
                   .places = model.places.unseen});
  }
}

/// Reports filled-in surface that is far from everything that two stops saw: nothing measured says
/// where it should be.
void judge_fill(Judgement& judgement, const ScanFigures& scan, const ModelReport& model) {
  std::vector<Eigen::Vector3d> far_places;
  double farthest = max_fill;
  for (const Eigen::Vector3d& place : model.places.unseen) {
    double square = std::numeric_limits<double>::infinity();
    for (const Eigen::Vector3d& seen : scan.seen) {
      square = std::min(square, (seen - place).squaredNorm());
    }
    if (std::isfinite(square) && square > max_fill * max_fill) {
      far_places.push_back(place);
      farthest = std::max(farthest, std::sqrt(square));
    }
  }
  if (!far_places.empty()) {
    judgement.add(Verdict::look,
                  {.code = "filled-far",
                   .detail = "the model is filled in up to " + mm_text(farthest, text_digits) +
                             " from everything that was seen",
                   .hint = unseen_hint,
                   .parameters = {{"fill_mm", mm_from_metres(farthest)}},
                   .places = std::move(far_places)});
  }
}

void judge_box(Judgement& judgement, const ScanFigures& scan) {
  struct Side {
    const char* name;
    const char* words;
  };
  constexpr std::array sides = {Side{"left", "the side towards -X"},
                                Side{"right", "the side towards +X"},
                                Side{"near", "the side towards the sensor"},
                                Side{"far", "the far side"}, Side{"top", "the top"}};
  const auto worst = std::ranges::max_element(scan.cut_pixels);
  if (*worst > max_cut_pixels) {
    const auto side = static_cast<std::size_t>(worst - scan.cut_pixels.begin());
    judgement.add(Verdict::look,
                  {.code = "cut-by-box",
                   .detail = "the object reaches through " + std::string(sides[side].words) +
                             " of the scanned space",
                   .hint = "Make the scanned space larger, or move the object.",
                   .parameters = {{"side", sides[side].name}},
                   .places = scan.cut_places[side]});
  }
}

void add_missing(Judgement& judgement, MissingPart missing) {
  judgement.add(
      Verdict::look,
      {.code = "part-missing",
       .detail = "a part of the object, " + mm_text(missing.length, text_digits) +
                 " long, was seen by several stops and is not in the model",
       .hint = "Make the sensor's map, calibrate the rig, and scan with more stops or finer.",
       .parameters = {{"length_mm", mm_from_metres(missing.length)}},
       .places = std::move(missing.places)});
}

void judge_parts(Judgement& judgement, const ScanFigures& scan, const ModelReport& model) {
  auto missing = find_missing_part(scan, model);
  if (model.dropped.volume > min_dropped && model.dropped.volume > max_dropped * model.volume) {
    judgement.add(
        model.dropped.volume > model.volume ? Verdict::bad : Verdict::look,
        {.code = "parts-dropped",
         .detail = std::to_string(model.dropped.count) + " parts, " +
                   number_text("%.1f cm3 in all", cm3_from_m3(model.dropped.volume)) +
                   ", were not joined to the model, and were dropped",
         .hint = "Scan one object at a time, or build the model of all parts.",
         .parameters = {{"parts", static_cast<double>(model.dropped.count)},
                        {"volume_cm3", cm3_from_m3(model.dropped.volume)}},
         .places = missing ? std::move(missing->places) : std::vector<Eigen::Vector3d>()});
  } else if (missing) {
    add_missing(judgement, *std::move(missing));
  }
}

/// Judges another pose of a model. Filled surface and dropped parts belong to no single pose.
Quality judge_side(const ScanFigures& scan, const ModelReport& model) {
  Judgement judgement;
  judge_agreement(judgement, scan);
  judge_height(judgement, scan, {});
  if (scan.platform_height.value_or(0) <= look_height) {
    judge_box(judgement, scan);
    if (auto missing = find_missing_part(scan, model)) {
      add_missing(judgement, *std::move(missing));
    }
  }
  return judgement.take();
}

/// Adds the reasons of another pose whose codes are new. @param side  number of the pose, from 1
void add_reasons(Quality& quality, Quality other, std::size_t side) {
  quality.verdict = std::max(quality.verdict, other.verdict);
  for (QualityReason& reason : other.reasons) {
    if (!std::ranges::count(quality.reasons, reason.code, &QualityReason::code)) {
      reason.detail.insert(0, "side " + std::to_string(side) + ": ");
      reason.parameters.emplace("object_side", static_cast<double>(side));
      quality.reasons.push_back(std::move(reason));
    }
  }
}

}  // namespace

std::string_view to_string(Verdict verdict) {
  constexpr std::array<std::string_view, 3> names = {"good", "look", "bad"};
  return names[static_cast<std::size_t>(verdict)];
}

std::optional<SizeError> expected_size_error(const Scan& scan, const Eigen::Vector3d& size,
                                             const std::optional<SolvedOptics>& seen) {
  if (scan.laser || has_free_poses(scan)) {
    return std::nullopt;
  }
  double focal = focal_sigma(scan, scan.solved, seen);
  for (const ScanPose& pose : scan.poses) {
    focal = std::max(focal, focal_sigma(scan, pose.solved, {}));
  }
  const double length = size.maxCoeff();
  const double surface = scan.sensor_map ? mapped_surface_sigma : unmapped_surface_sigma;
  return SizeError{
      .length = length,
      .error = stated_sigmas * std::hypot(length * std::hypot(scan.scale_sigma, focal), surface)};
}

Quality judge(const ScanFigures& scan, const ModelReport& model,
              std::span<const CalibrationFinding> findings) {
  Judgement judgement;
  if (scan.object_pixels < min_object_pixels || model.volume + model.dropped.volume < min_volume) {
    judgement.add(Verdict::bad, {.code = "empty",
                                 .detail = "next to nothing stands on the platform",
                                 .hint = "Stand the object on the platform's middle."});
    return judgement.take();
  }
  judge_agreement(judgement, scan);
  judge_findings(judgement, findings);
  judge_height(judgement, scan, model);
  judge_coverage(judgement, scan, model);
  if (scan.by_lines) {  // a depth sensor does not see below what overhangs
    judge_fill(judgement, scan, model);
  }
  if (scan.platform_height.value_or(0) <= look_height) {  // else they would judge the platform
    judge_box(judgement, scan);
    judge_parts(judgement, scan, model);
  }
  return judgement.take();
}

Quality judge(std::span<const ScanFigures> poses, const ModelReport& model,
              std::span<const CalibrationFinding> findings) {
  ScanFigures first = poses.front();
  // Another pose may have seen what lies in a gap between the stops of one, or what is filled in.
  first.widest_gap = std::ranges::min(poses, {}, &ScanFigures::widest_gap).widest_gap;
  first.by_lines = first.by_lines && poses.size() == 1;
  Quality quality = judge(first, model, findings);
  for (std::size_t i = 1; i < poses.size(); ++i) {
    add_reasons(quality, judge_side(poses[i], model), i + 1);
  }
  return quality;
}

}  // namespace octurn
