#include "store/model_json.hpp"

#include <nlohmann/json.hpp>
#include <vector>

#include "octurn/units.hpp"
#include "store/json_numbers.hpp"
#include "store/quality_json.hpp"

namespace octurn {
namespace {

using nlohmann::json;

constexpr double max_whole = 1e15;  // a double holds every whole number up to there

std::uint64_t count(const JsonValue& value) {
  return static_cast<std::uint64_t>(value.number(0, max_whole));
}

std::optional<Quality> quality_from(const std::optional<JsonValue>& object) {
  return !object || object->json().is_null() ? std::nullopt : std::optional(to_quality(*object));
}

}  // namespace

json to_json(const Model& model) {
  const ModelReport& report = model.report;
  const bool counted = report.parts > 0;
  json size_mm = json::array();
  for (const double side : report.size) {
    size_mm.push_back(to_thousandths(mm_from_metres(side)));
  }
  return {{"parts", counted ? json(report.parts) : json()},
          {"dropped_parts", counted ? json(report.dropped.count) : json()},
          {"dropped_volume_cm3",
           counted ? json(to_thousandths(cm3_from_m3(report.dropped.volume))) : json()},
          {"filled_share", counted ? json(to_thousandths(report.filled_share)) : json()},
          {"bytes", report.bytes},
          {"triangles", report.triangles},
          {"leaves", report.leaves},
          {"watertight", report.watertight},
          {"volume_cm3", to_thousandths(cm3_from_m3(report.volume))},
          {"size_mm", std::move(size_mm)},
          {"seconds", to_thousandths(model.build_time.count())},
          {"quality", model.quality ? to_json(*model.quality) : json()}};
}

Model to_model(const JsonValue& object) {
  JsonObject keys(object);
  Model model{
      .report = {.leaves = count(keys.at("leaves")),
                 .triangles = count(keys.at("triangles")),
                 .bytes = count(keys.at("bytes")),
                 .parts = static_cast<std::uint64_t>(number_or_zero(keys, "parts", max_whole)),
                 .filled_share = number_or_zero(keys, "filled_share", 1),
                 .watertight = keys.flag("watertight").value_or(false),
                 .volume = m3_from_cm3(keys.at("volume_cm3").number(0, unlimited)),
                 .dropped = {.count = static_cast<std::uint64_t>(
                                 number_or_zero(keys, "dropped_parts", max_whole)),
                             .volume = m3_from_cm3(
                                 number_or_zero(keys, "dropped_volume_cm3", unlimited))}},
      .build_time = Seconds(keys.at("seconds").number(0, unlimited)),
      .quality = quality_from(keys.value("quality"))};
  const std::vector<JsonValue> size = keys.at("size_mm").elements(3);
  for (int axis = 0; axis < 3; ++axis) {
    model.report.size[axis] = metres_from_mm(size[static_cast<std::size_t>(axis)].number());
  }
  return model;
}

}  // namespace octurn
