#include "octurn/quality.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <numbers>
#include <utility>

#include "calibrate/checked_stop.hpp"
#include "calibrate/missing_part.hpp"
#include "calibrate/object_view.hpp"
#include "io/number_text.hpp"
#include "octurn/units.hpp"

namespace octurn {
namespace {

constexpr double min_volume = 1e-7;  // cubic metres

constexpr double bad_disagreements = 2;   // as many times what deserves a look
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

constexpr double max_fill = 0.03;        // metres from anything that was seen
constexpr double max_unseen_top = 0.01;  // metres: a Kinect loses 2 to 4 pixels at an edge
constexpr double min_hollow = 0.015;     // metres, depth of a filled hollow
constexpr std::size_t min_hollow_places = 8;
constexpr std::size_t most_stops_of_few = 3;
constexpr double max_cut_pixels = 6;  // a depth image: 7 mm at 0.65 m
constexpr double max_dropped = 0.01;  // of the model's volume
constexpr double min_dropped = 2e-7;  // cubic metres
constexpr double max_crumb = 5e-8;    // cubic metres, of the platform's noise

// Of a model by intersection, metres beyond a leaf: the swelling that its readings' noise makes.
constexpr double max_swelling = 0.0018;
constexpr double max_stray = 0.01;                 // of its leaves
constexpr double max_beyond = 0.02;                // metres, two cells, their swelling and leaves
constexpr std::uint64_t large_file = 200'000'000;  // bytes: four million triangles

constexpr const char* solid_hint = "Build the model again with the method solid.";

constexpr int text_digits = 1;  // of millimetres

// Metres, sigma of the distance between two opposite surfaces of a model: noise and what a map
// leaves of the sensor's pattern. Without a map the pattern of 0.8 units of disparity remains.
constexpr double mapped_surface_sigma = 0.00012;
constexpr double unmapped_surface_sigma = 0.0003;
constexpr double data_sheet_focal_sigma = 0.015;  // relative, of published units
constexpr double stated_sigmas = 2;

constexpr double max_warm_up = 300;  // seconds between a scan and its map
constexpr double warm = 1800;        // seconds; sensors of this kind drift for 30 to 60 minutes

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

/// Where in the chain from the turn to the model a reason belongs. What is earlier causes what is
/// later.
enum class Link { platform, turn, pose, sight, model };

Link find_link(const QualityReason& reason) {
  using CodeLink = std::pair<std::string_view, Link>;
  constexpr std::array<CodeLink, 14> links{{{"empty", Link::platform},
                                            {"too-low", Link::platform},
                                            {"lasers-exchanged", Link::turn},
                                            {"turntable", Link::turn},
                                            {"alike", Link::turn},
                                            {"top-unseen", Link::sight},
                                            {"little-seen", Link::sight},
                                            {"filled-far", Link::sight},
                                            {"cut-by-box", Link::sight},
                                            {"hollow-filled", Link::model},
                                            {"parts-dropped", Link::model},
                                            {"part-missing", Link::model},
                                            {"swollen", Link::model},
                                            {"large-file", Link::model}}};
  if (reason.code == "moved") {  // found by the calibration, or by what other stops saw through
    return reason.parameters.contains("empty_share") ? Link::sight : Link::turn;
  }
  const auto found = std::ranges::find(links, reason.code, &CodeLink::first);
  return found == links.end() ? Link::pose : found->second;
}

/// Whether a reason follows from another, whose cure cures both. A wrong pose hides no surface.
bool follows(Link reason, Link cause) {
  return cause < reason && (cause < Link::pose || reason == Link::model);
}

/// Leaves out what follows from another reason.
void keep_causes(Quality& quality) {
  std::vector<Link> links;
  std::ranges::transform(quality.reasons, std::back_inserter(links), find_link);
  std::erase_if(quality.reasons, [&](const QualityReason& reason) {
    return std::ranges::any_of(links,
                               [&](Link cause) { return follows(find_link(reason), cause); });
  });
  std::ranges::stable_sort(quality.reasons, {}, find_link);
}

/// Collects reasons; the worst of them is the verdict.
class Judgement {
 public:
  void add(Verdict verdict, QualityReason reason) {
    quality_.verdict = std::max(quality_.verdict, verdict);
    quality_.reasons.push_back(std::move(reason));
  }
  Quality take() {
    keep_causes(quality_);
    return std::move(quality_);
  }

 private:
  Quality quality_ = {};
};

void judge_agreement(Judgement& judgement, const ScanFigures& scan) {
  const double look_disagreement = scan.sensor.disagreement_at_1_m *
                                   std::pow(std::max(scan.distance, scan.sensor.noise_distance), 2);
  if (scan.disagreement > look_disagreement) {
    judgement.add(
        scan.disagreement > bad_disagreements * look_disagreement ? Verdict::bad : Verdict::look,
        {.code = "stops-disagree",
         .detail =
             "two stops disagree about the object by " + mm_text(scan.disagreement, text_digits),
         .hint = "Calibrate the rig, and check that object and sensor stand firm.",
         .parameters = {{"disagreement_mm", mm_from_metres(scan.disagreement)}},
         .places = scan.differing.disagreeing});
  }
  const auto odd = std::ranges::max_element(scan.contradicted);
  if (scan.disagreement <= look_disagreement && odd != scan.contradicted.end() &&
      *odd > max_contradicted) {
    judgement.add(
        Verdict::look,
        {.code = "moved",
         .detail = "at stop " + std::to_string(odd - scan.contradicted.begin()) + " " +
                   percent_text(*odd) + " of what was seen lies where other stops saw empty space",
         .hint = "Keep hands out of the picture, and check that nothing moves.",
         .parameters = {{"stop", static_cast<double>(odd - scan.contradicted.begin())},
                        {"empty_share", *odd}},
         .places = scan.differing.contradicted});
  }
}

/// What a calibration found that the model suffers from.
void judge_findings(Judgement& judgement, std::span<const CalibrationFinding> findings) {
  constexpr std::array<std::string_view, 5> of_the_turntable{"slip", "turn-not-whole", "still",
                                                             "turn-ratio", "turn-unknown"};
  constexpr std::array<std::string_view, 6> others{"moved", "focal-length",   "optics",
                                                   "alike", "stops-disagree", "lasers-exchanged"};
  for (const CalibrationFinding& finding : findings) {
    const bool is_turntable = std::ranges::count(of_the_turntable, finding.code) > 0;
    if (!is_turntable && std::ranges::count(others, finding.code) == 0) {
      continue;
    }
    const bool is_bad =
        (is_turntable && finding.code != "slip" && finding.code != "turn-not-whole") ||
        finding.code == "lasers-exchanged";
    judgement.add(is_bad ? Verdict::bad : Verdict::look,
                  {.code = is_turntable ? "turntable" : finding.code,
                   .detail = finding.detail,
                   .hint = finding.hint,
                   .parameters = finding.parameters});
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
         .hint = "Dull the object's foot if it is black, shiny or clear; look whether the box "
                 "reaches down to the platform.",
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
         .hint =
             scan.stops > most_stops_of_few ? "Scan a whole turn." : "Scan with more snapshots.",
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

/// Reports a hole in the readings above the object, at most stops.
void judge_top(Judgement& judgement, const ScanFigures& scan) {
  if (scan.unseen_top > max_unseen_top) {
    judgement.add(Verdict::look,
                  {.code = "top-unseen",
                   .detail = "the top was not seen: the sensor reads nothing in the " +
                             mm_text(scan.unseen_top, 0) + " above the model",
                   .hint = "Dull what is black, shiny or clear with chalk or dry shampoo.",
                   .parameters = {{"unseen_mm", mm_from_metres(scan.unseen_top)}}});
  }
}

/// The height to which an object was seen all around a place, metres; nothing if it was not, or if
/// something was seen above the place.
std::optional<double> find_rim(const ScanFigures& scan, const Eigen::Vector3d& place) {
  constexpr double beside = 0.007;  // metres: not of the wall of a vessel
  std::array<double, 8> highest{};
  for (const Eigen::Vector3d& seen : scan.seen) {
    const Eigen::Vector3d from_place = seen - place;
    if (from_place.z() < min_hollow) {
      continue;
    }
    if (from_place.head<2>().norm() < beside) {
      return std::nullopt;
    }
    const double turn = std::atan2(from_place.y(), from_place.x()) / (2 * std::numbers::pi) + 0.5;
    double& rim = highest[static_cast<std::size_t>(turn * 8) % 8];
    rim = std::max(rim, from_place.z());
  }
  const double rim = *std::ranges::min_element(highest);
  return rim > 0 ? std::optional(rim) : std::nullopt;
}

/// Mentions a deep hollow whose floor no stop saw: there the model is filled up.
void judge_hollow(Judgement& judgement, const ScanFigures& scan, const ModelReport& model) {
  constexpr double floor = 0.006;  // metres above the lowest readings: it may lie below the box
  double lowest = std::numeric_limits<double>::infinity();
  for (const Eigen::Vector3d& seen : scan.seen) {
    lowest = std::min(lowest, seen.z());
  }
  double depth = 0;
  std::vector<Eigen::Vector3d> places;
  for (const Eigen::Vector3d& place : model.places.unseen) {
    const bool is_floor = place.z() < lowest + floor;
    if (const auto rim = is_floor ? std::nullopt : find_rim(scan, place)) {
      depth = std::max(depth, *rim);
      places.push_back(place);
    }
  }
  if (places.size() >= min_hollow_places) {
    judgement.add(Verdict::good,
                  {.code = "hollow-filled",
                   .detail = "a hollow is filled up to " + mm_text(depth, 0) +
                             " below its rim, since no stop saw its floor",
                   .hint = "Tilt the sensor further down, or scan the object from another side.",
                   .parameters = {{"hollow_mm", mm_from_metres(depth)}},
                   .places = std::move(places)});
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
  const bool are_crumbs =
      !missing && model.dropped.volume < max_crumb * static_cast<double>(model.dropped.count);
  if (!are_crumbs && model.dropped.volume > min_dropped &&
      model.dropped.volume > max_dropped * model.volume) {
    judgement.add(
        model.dropped.volume > model.volume ? Verdict::bad : Verdict::look,
        {.code = "parts-dropped",
         .detail =
             (model.dropped.count == 1
                  ? number_text("1 part, %.1f cm3, was", cm3_from_m3(model.dropped.volume))
                  : std::to_string(model.dropped.count) + " parts, " +
                        number_text("%.1f cm3 in all, were", cm3_from_m3(model.dropped.volume))) +
             " not joined to the model, and dropped",
         .hint = "Scan one object at a time, or build the model of all parts.",
         .parameters = {{"parts", static_cast<double>(model.dropped.count)},
                        {"volume_cm3", cm3_from_m3(model.dropped.volume)}},
         .places = missing ? std::move(missing->places) : std::vector<Eigen::Vector3d>()});
  } else if (missing) {
    add_missing(judgement, *std::move(missing));
  }
}

/// By how much a model is larger than what several stops saw, metres.
double size_beyond(const ScanFigures& scan, const ModelReport& model) {
  Eigen::AlignedBox3d seen;
  for (const Eigen::Vector3d& middle : scan.seen) {
    if (middle.z() > scan.below.noise_end + object_cell_side / 2) {
      seen.extend(middle);
    }
  }
  const Eigen::Vector3d cell = Eigen::Vector3d::Constant(object_cell_side);
  return seen.isEmpty() ? 0 : (model.size - seen.sizes() - cell).head<2>().maxCoeff();
}

/// Judges the hollow shell of the method `intersection`, which encloses the noise of all stops.
void judge_shell(Judgement& judgement, const ScanFigures& scan, const ModelReport& model) {
  if (model.places.leaves.empty()) {
    return;
  }
  if (scan.shell.swelling > max_swelling * scan.noise_growth() + voxel_side(model)) {
    judgement.add(Verdict::look,
                  {.code = "swollen",
                   .detail = "the surface lies up to " + mm_text(scan.shell.swelling, text_digits) +
                             " outside of what the stops saw",
                   .hint = solid_hint,
                   .parameters = {{"swelling_mm", mm_from_metres(scan.shell.swelling)}}});
  } else if (scan.shell.stray_share > max_stray) {
    judgement.add(Verdict::look, {.code = "swollen",
                                  .detail = percent_text(scan.shell.stray_share) +
                                            " of the surface lies where the stops saw empty space",
                                  .hint = solid_hint,
                                  .parameters = {{"stray_share", scan.shell.stray_share}}});
  } else if (const double beyond = size_beyond(scan, model); beyond > max_beyond) {
    judgement.add(Verdict::look,
                  {.code = "swollen",
                   .detail = "stray pieces make the model " + mm_text(beyond, text_digits) +
                             " larger than what several stops saw",
                   .hint = solid_hint,
                   .parameters = {{"stray_mm", mm_from_metres(beyond)}}});
  }
  if (model.bytes > large_file) {
    const double mb = std::round(decimal_mb_from_bytes(static_cast<double>(model.bytes)));
    judgement.add(Verdict::look, {.code = "large-file",
                                  .detail = "the file has " + number_text("%.0f MB", mb) +
                                            ", which few slicers open",
                                  .hint = solid_hint,
                                  .parameters = {{"file_mb", mb}}});
  }
}

/// Reports an object that lies between the platform's noise and the box.
void judge_low(Judgement& judgement, const ScanFigures& scan) {
  judgement.add(
      Verdict::bad,
      {.code = "too-low",
       .detail = "what lies on the platform is lower than the scanned space, which could "
                 "begin " +
                 mm_text(scan.below.possible_bottom(), text_digits) + " above the platform",
       .hint = "Build the model again with a scanned space that begins lower.",
       .parameters = {{"noise_end_mm", mm_from_metres(scan.below.possible_bottom())}}});
}

/// Judges another pose of a model. Filled surface and dropped parts belong to no single pose.
/// @param scan  heights in its places are not above this pose's platform
Quality judge_side(ScanFigures scan, const ModelReport& model) {
  Judgement judgement;
  scan.below.noise_end = 0;
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

double ScanFigures::noise_growth() const {
  return std::pow(std::max(distance / sensor.noise_distance, 1.0), 2);
}

bool BelowBox::has_most(double inside) const {
  return noise_end > 0 && pixels > min_object_pixels &&
         (inside < min_object_pixels || pixels > inside);
}

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

void expect_higher_object(const Error& error, const PoseChecks& checks) {
  if (error.code() != ErrorCode::model_empty) {
    return;
  }
  if (const auto bottom = checks.lower_bottom()) {
    throw Error(ErrorCode::model_empty, "what lies on the platform is lower than the scanned space",
                "Build the model again with a scanned space that begins " +
                    number_text("%.1f mm", mm_from_metres(*bottom)) + " above the platform.");
  }
}

void add_warm_up(Quality& quality, const Scan& scan) {
  if (!scan.sensor_map || !scan.sensor_map->on_for || !scan.sensor_on_for) {
    return;
  }
  const double of_scan = std::min(*scan.sensor_on_for, warm);
  const double of_map = std::min(*scan.sensor_map->on_for, warm);
  if (std::abs(of_scan - of_map) > max_warm_up) {
    const double scan_min = std::round(*scan.sensor_on_for / 60);
    const double map_min = std::round(*scan.sensor_map->on_for / 60);
    quality.reasons.push_back(
        {.code = "warm-up",
         .detail = "the sensor had been on for " + number_text("%.0f", scan_min) +
                   " minutes at this scan, and for " + number_text("%.0f", map_min) +
                   " when its map was made: its error changes while it warms up",
         .hint = "Let the sensor warm up, and keep it on between scans, which is a setting; then "
                 "make its map again.",
         .parameters = {{"scan_min", scan_min}, {"map_min", map_min}}});
  }
}

Quality judge(const ScanFigures& scan, const ModelReport& model,
              std::span<const CalibrationFinding> findings) {
  Judgement judgement;
  const bool is_empty =
      scan.object_pixels < min_object_pixels || model.volume + model.dropped.volume < min_volume;
  if (scan.below.has_most(is_empty ? 0 : scan.object_pixels)) {
    judge_low(judgement, scan);
    return judgement.take();
  }
  if (is_empty) {
    judgement.add(Verdict::bad, {.code = "empty",
                                 .detail = "next to nothing stands on the platform",
                                 .hint = "Stand the object on the platform's middle."});
    return judgement.take();
  }
  judge_agreement(judgement, scan);
  judge_findings(judgement, findings);
  judge_height(judgement, scan, model);
  judge_top(judgement, scan);
  judge_coverage(judgement, scan, model);
  judge_hollow(judgement, scan, model);
  if (scan.sensor.sees_lines) {  // a depth sensor does not see below what overhangs
    judge_fill(judgement, scan, model);
  }
  if (scan.platform_height.value_or(0) <= look_height) {  // else they would judge the platform
    judge_box(judgement, scan);
    judge_parts(judgement, scan, model);
  }
  judge_shell(judgement, scan, model);
  return judgement.take();
}

Quality judge(std::span<const ScanFigures> poses, const ModelReport& model,
              std::span<const CalibrationFinding> findings) {
  ScanFigures first = poses.front();
  // Another pose may have seen what lies in a gap between the stops of one, or what is filled in.
  first.widest_gap = std::ranges::min(poses, {}, &ScanFigures::widest_gap).widest_gap;
  first.sensor.sees_lines = first.sensor.sees_lines && poses.size() == 1;
  Quality quality = judge(first, model, findings);
  for (std::size_t i = 1; i < poses.size(); ++i) {
    add_reasons(quality, judge_side(poses[i], model), i + 1);
  }
  keep_causes(quality);
  return quality;
}

Quality judge(const PoseChecks& checks, int threads, const Scan& scan, const ModelReport& model,
              std::span<const CalibrationFinding> findings,
              const std::optional<SolvedOptics>& seen) {
  Quality quality = judge(checks.figures(threads, model.places.leaves), model, findings);
  quality.size_error = expected_size_error(scan, model.size, seen);
  add_warm_up(quality, scan);
  return quality;
}

}  // namespace octurn
