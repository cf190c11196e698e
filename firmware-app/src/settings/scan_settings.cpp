#include "settings/scan_settings.hpp"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <nlohmann/json.hpp>
#include <thread>
#include <utility>

#include "octurn/units.hpp"
#include "settings/field.hpp"
#include "settings/pose_field.hpp"

namespace octurn {
namespace {

using nlohmann::json;

constexpr int max_frames = 100;  // 3 s at 30 frames a second: more does not lower the noise
constexpr int max_threads = 256;
constexpr double max_root_mm = 10000;
constexpr double min_leaf_mm = 0.1;  // larger roots need more: see `check_leaf`
constexpr double min_scale = 0.01;
constexpr double max_scale = 100;
constexpr int min_triangles = 100;
constexpr int max_triangles = 100'000'000;
constexpr double min_memory_mb = 17;  // of the intersection method with one thread

// Memory of program and libraries without a reconstruction, measured on x86-64.
const auto solid_program_bytes = static_cast<std::size_t>(bytes_from_mb(12));
const auto intersection_program_bytes = static_cast<std::size_t>(bytes_from_mb(10));

/// @return nullopt unless these are six numbers in range that span a box of positive volume
std::optional<Box> box_from(const json& mm, double max_coordinate_mm) {
  const auto in_range = [&](const json& value) {
    return value.is_number() && std::abs(value.get<double>()) <= max_coordinate_mm;
  };
  if (!mm.is_array() || mm.size() != 6 || !std::ranges::all_of(mm, in_range)) {
    return std::nullopt;
  }
  const auto corner = [&](std::size_t first) {
    const auto metres = [&](std::size_t i) { return metres_from_mm(mm[i].get<double>()); };
    return Eigen::Vector3d(metres(first), metres(first + 1), metres(first + 2));
  };
  const Box box{.min = corner(0), .max = corner(3)};
  return (box.min.array() < box.max.array()).all() ? std::optional(box) : std::nullopt;
}

json to_mm(const Box& box) {
  json mm = json::array();
  for (const Eigen::Vector3d& corner : {box.min, box.max}) {
    for (const double metres : corner) {
      mm.push_back(rounded_mm(metres));
    }
  }
  return mm;
}

Access box(Box& value, double max_coordinate_mm) {
  const json side{
      {"type", "number"}, {"minimum", -max_coordinate_mm}, {"maximum", max_coordinate_mm}};
  return {.read =
              [&value, max_coordinate_mm, side](const JsonValue& given) {
                const auto box = box_from(given.json(), max_coordinate_mm);
                if (!box) {
                  given.refuse("six numbers, x0 y0 z0 x1 y1 z1, from " + allowed_text(side) +
                               ", each of the first three below its partner");
                }
                value = *box;
              },
          .write = [&value] { return to_mm(value); },
          .schema = {{"type", "array"}, {"items", side}, {"minItems", 6}, {"maxItems", 6}}};
}

constexpr double max_edit_mm = 1e6;
constexpr std::size_t max_edits = 200;

json row_schema(std::size_t numbers, const char* title) {
  return {{"type", "array"},
          {"items", {{"type", "number"}}},
          {"minItems", numbers},
          {"maxItems", numbers},
          {"title", title}};
}

std::vector<double> row_from(const JsonValue& given, std::size_t numbers) {
  std::vector<double> row;
  for (const JsonValue& number : given.elements(numbers)) {
    row.push_back(number.number(-max_edit_mm, max_edit_mm));
  }
  return row;
}

Eigen::Vector3d point_from(const std::vector<double>& row, std::size_t first) {
  return metres_from_mm(1) * Eigen::Vector3d(row[first], row[first + 1], row[first + 2]);
}

Eigen::Vector3d direction_from(const JsonValue& given, const std::vector<double>& row) {
  const Eigen::Vector3d direction(row[0], row[1], row[2]);
  if (direction.norm() < 1e-6) {
    given.refuse("a direction and a length, and the direction not 0 0 0");
  }
  return direction.normalized();
}

/// A list of rows of four numbers.
template <typename Edit>
Access rows_of_four(std::vector<Edit>& value, const char* title,
                    Edit (*from)(const JsonValue& given, const std::vector<double>& row),
                    json (*to_row)(const Edit& edit)) {
  return {.read =
              [&value, from](const JsonValue& given) {
                std::vector<Edit> edits;
                for (const JsonValue& row : given.elements()) {
                  edits.push_back(from(row, row_from(row, 4)));
                }
                if (edits.size() > max_edits) {
                  given.refuse("at most " + std::to_string(max_edits) + " rows");
                }
                value = std::move(edits);
              },
          .write =
              [&value, to_row] {
                json rows = json::array();
                std::ranges::transform(value, std::back_inserter(rows), to_row);
                return rows;
              },
          .schema = {{"type", "array"}, {"items", row_schema(4, title)}, {"maxItems", max_edits}}};
}

CutPlane cut_from(const JsonValue& given, const std::vector<double>& row) {
  return {.normal = direction_from(given, row), .distance = metres_from_mm(row[3])};
}

json to_row(const CutPlane& cut) {
  return {cut.normal.x(), cut.normal.y(), cut.normal.z(), rounded_mm(cut.distance)};
}

ErasedBall ball_from(const JsonValue& given, const std::vector<double>& row) {
  if (row[3] <= 0) {
    given.refuse("x, y, z and a radius above 0");
  }
  return {.centre = point_from(row, 0), .radius = metres_from_mm(row[3])};
}

json to_row(const ErasedBall& ball) {
  return {rounded_mm(ball.centre.x()), rounded_mm(ball.centre.y()), rounded_mm(ball.centre.z()),
          rounded_mm(ball.radius)};
}

Access laid_side(std::optional<LaidSide>& value) {
  return {.read =
              [&value](const JsonValue& given) {
                if (given.json().is_null()) {
                  value.reset();
                  return;
                }
                const std::vector<double> row = row_from(given, 6);
                value = LaidSide{.down = direction_from(given, row), .point = point_from(row, 3)};
              },
          .write = [&value]() -> json {
            if (!value) {
              return nullptr;
            }
            const auto& [down, point] = *value;
            return {down.x(),
                    down.y(),
                    down.z(),
                    rounded_mm(point.x()),
                    rounded_mm(point.y()),
                    rounded_mm(point.z())};
          },
          .schema = row_schema(6, "DX DY DZ X Y Z")};
}

std::vector<Field> capture_fields(ScanSettings& s, const SettingRanges& ranges) {
  return {
      {.key = "snapshots",
       .help = "stops in a turn",
       .access = whole(s.snapshots, 1, ranges.max_snapshots)},
      {.key = "filter",
       .help = "how the frames of a stop become one: basic takes the first, average the mean at "
               "each pixel, average-discard only where every frame has a reading",
       .access = choice(s.filter,
                        {DepthFilter::basic, DepthFilter::average, DepthFilter::average_discard})},
      {.key = "frames",
       .help = "frames at each stop, for the filters that merge",
       .access = whole(s.frames, 1, max_frames)},
  };
}

std::vector<Field> joined(std::vector<Field> fields, const std::vector<Field>& more) {
  fields.insert(fields.end(), more.begin(), more.end());
  return fields;
}

}  // namespace

std::vector<Field> fields(ScanSettings& s, const SettingRanges& ranges) {
  return joined(scan_fields(s, ranges),
                {{.key = "platform_from_sensor",
                  .unit = "m",
                  .help = "pose of the sensor: four rows of four numbers",
                  .access = pose(s.platform_from_sensor),
                  .default_text = "0.62 m before the axis, 0.36 m up, 25 degrees down"},
                 {.key = "depth_scale",
                  .help = "factor of the sensor's depths, from one length measured with calipers",
                  .access = number(s.depth_scale, min_depth_scale, max_depth_scale)}});
}

std::vector<Field> model_fields(ScanSettings& s, const SettingRanges& ranges) {
  return {
      {.key = "method",
       .help = "solid: one closed, filled, smooth part; intersection: a shell of what was seen",
       .access = choice(s.method, {Method::solid, Method::intersection})},
      {.key = "leaf_size_mm",
       .unit = "mm",
       .help = "largest side of a leaf; the root is halved until it fits",
       .access = number(s.leaf_size, min_leaf_mm, max_root_mm, millimetres)},
      {.key = "max_error_mm",
       .unit = "mm",
       .help = "root mean square distance that fewer triangles may cost, a target and no bound; 0 "
               "keeps "
               "them all",
       .access = number(s.target_error, 0, 1000, millimetres),
       .method = "solid"},
      {.key = "parts",
       .help = "main keeps the object, one connected part; all keeps every part that stands on the "
               "platform, unless the object was turned over",
       .access = choice(s.parts, {Parts::main, Parts::all}),
       .method = "solid"},
      {.key = "threshold_m2",
       .unit = "m2",
       .help = "square of the longest side that a triangle may have",
       .access = number(s.threshold, 1e-8, 1),
       .method = "intersection"},
      {.key = "calibrate",
       .help =
           "pose of the sensor: auto solves it from the snapshots, told takes the configured one",
       .access = choice(s.pose, {PoseSource::solved, PoseSource::configured})},
      {.key = "root_size_mm",
       .unit = "mm",
       .help = "side of the root cube",
       .access = number(s.root_size, 10, max_root_mm, millimetres)},
      {.key = "clip_mm",
       .unit = "mm",
       .help = "box around the object in the platform frame: its smallest x, y, z and its largest",
       .access = box(s.clip, ranges.max_coordinate_mm)},
  };
}

std::vector<Field> scan_fields(ScanSettings& s, const SettingRanges& ranges) {
  return joined(capture_fields(s, ranges), model_fields(s, ranges));
}

std::vector<Field> fields(EditSettings& settings) {
  ModelEdits& edits = settings.edits;
  return {
      {.key = "cut_mm",
       .unit = "mm",
       .help = "planes that cut the model, each by the direction towards what is cut off and the "
               "distance from the origin along it; the section is closed",
       .access = rows_of_four<CutPlane>(edits.cuts, "X Y Z D", cut_from, to_row),
       .method = "solid",
       .default_text = "none"},
      {.key = "erase_mm",
       .unit = "mm",
       .help = "balls that are erased, each by its centre and radius; the surface is closed",
       .access = rows_of_four<ErasedBall>(edits.erased, "X Y Z R", ball_from, to_row),
       .method = "solid",
       .default_text = "none"},
      {.key = "lay_mm",
       .unit = "mm",
       .help = "lays the model on another side: the direction that becomes down, and the point "
               "that becomes the origin",
       .access = laid_side(edits.lay),
       .default_text = "as scanned"},
      {.key = "scale",
       .help = "factor of the model's size",
       .access = number(edits.scale, min_scale, max_scale)},
      {.key = "max_triangles",
       .help = "number of triangles that the model may have: max_error_mm is raised until it has "
               "no more; a build that cannot have so few is refused",
       .access = whole(settings.max_triangles, min_triangles, max_triangles),
       .method = "solid",
       .default_text = "no limit"},
  };
}

std::vector<Field> fields(Limits& limits) {
  return {
      {.key = "threads",
       .help = "threads of a reconstruction",
       .access = whole(limits.threads, 1, max_threads),
       .default_text = "all cores"},
      {.key = "memory_limit_mb",
       .unit = "MB",
       .help = "memory that the program may take; less of it takes longer",
       .access = megabytes(limits.memory_bytes, min_memory_mb, 1e6),
       .default_text = limits.memory_bytes == 0 ? "no limit" : "half of the machine's memory"},
  };
}

std::vector<Field> fields(ModelSettings& settings) {
  std::vector<Field> model = model_fields(settings.scan);
  for (Field& field : model) {
    field.default_text = field.key == "method"         ? "solid; of a space: intersection"
                         : field.key == "leaf_size_mm" ? "1; by laser line: 0.5"
                         : field.key == "max_error_mm" ? "0.04; by laser line: 0.01"
                         : field.key == "clip_mm"      ? "the scan's"
                                                       : "";
  }
  model.push_back({.key = "level",
                   .help = "surface of a coarser level; 0 is the root",
                   .access = whole(settings.level, 0, max_levels),
                   .method = "intersection",
                   .default_text = "the leaves'"});
  return joined(joined(std::move(model), fields(settings.edits)), fields(settings.limits));
}

std::string_view to_string(PoseSource source) {
  return source == PoseSource::solved ? "auto" : "told";
}

int available_threads() {
  return std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
}

std::size_t half_of_memory() {
  const double half = static_cast<double>(::sysconf(_SC_PHYS_PAGES)) / 2 *
                      static_cast<double>(::sysconf(_SC_PAGESIZE));
  return static_cast<std::size_t>(bytes_from_mb(std::floor(mb_from_bytes(half))));
}

void use_laser_defaults(ScanSettings& settings) {
  settings.leaf_size = laser_traits.leaf_size;
  settings.target_error = laser_traits.target_error;
}

ReconstructOptions reconstruct_options(const ScanSettings& settings, const Limits& limits) {
  return {.method = settings.method,
          .leaf_size = settings.leaf_size,
          .root_size = settings.root_size,
          .threshold = settings.threshold,
          .clip = settings.clip,
          .target_error = settings.target_error,
          .solid = {.parts = settings.parts},
          .threads = limits.threads,
          .memory_limit = limits.memory_bytes,
          .program_memory =
              settings.method == Method::solid ? solid_program_bytes : intersection_program_bytes};
}

void add_edits(ReconstructOptions& options, const EditSettings& settings) {
  options.edits = settings.edits;
  options.solid.max_triangles = settings.max_triangles;
}

json to_json(const ScanSettings& settings) {
  ScanSettings copy = settings;
  return to_json(fields(copy));
}

ScanSettings settings_from(const json& object, const ScanSettings& defaults,
                           const std::string& name) {
  JsonObject keys(object, ErrorCode::bad_settings, name);
  ScanSettings settings = defaults;
  read_fields(keys, fields(settings));
  check_leaf(keys, settings);
  check_clip(keys, settings);
  keys.refuse_unread();
  return settings;
}

ScanSettings stored_settings_from(const JsonValue& object) {
  JsonObject keys(object);
  ScanSettings settings;
  read_fields(keys, fields(settings, stored_ranges));
  keys.refuse_unread();
  return settings;
}

void check_edits(const JsonObject& keys, const EditSettings& edits, Method method) {
  EditSettings copy = edits;
  for (const Field& field : fields(copy)) {
    const json value = field.access.write();
    if (!field.method.empty() && field.method != to_string(method) && !value.empty()) {
      keys.refuse(field.key, value,
                  "left out: the method " + std::string(to_string(method)) + " has none");
    }
  }
}

void check_leaf(const JsonObject& keys, const ScanSettings& settings) {
  if (settings.leaf_size > settings.root_size) {
    keys.refuse("leaf_size_mm", rounded_mm(settings.leaf_size), "at most root_size_mm");
  }
  const double smallest = settings.root_size / (1 << max_levels);
  if (settings.leaf_size < smallest) {
    // Rounded up to a micrometre, so that what the message names is accepted.
    const double smallest_mm = std::ceil(mm_from_metres(smallest) * 1000) / 1000;
    keys.refuse("leaf_size_mm", rounded_mm(settings.leaf_size),
                "at least " + json(smallest_mm).dump() +
                    " with that root_size_mm, which is halved " + std::to_string(max_levels) +
                    " times at most");
  }
}

void check_clip(const JsonObject& keys, const ScanSettings& settings) {
  // Tolerates the rounding of millimetres to metres.
  const double thinnest = settings.leaf_size * (1 - 1e-9);
  if (((settings.clip.max - settings.clip.min).array() < thinnest).any()) {
    keys.refuse("clip_mm", to_mm(settings.clip), "as thick as leaf_size_mm or thicker");
  }
}

}  // namespace octurn
