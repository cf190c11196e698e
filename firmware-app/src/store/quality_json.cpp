#include "store/quality_json.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "octurn/units.hpp"
#include "store/parameters_json.hpp"

namespace octurn {
namespace {

using nlohmann::json;

constexpr std::array verdicts{Verdict::good, Verdict::look, Verdict::bad};

/// JSON of places, rounded to whole millimetres.
json to_places_mm(const std::vector<Eigen::Vector3d>& places) {
  json rows = json::array();
  for (const Eigen::Vector3d& place : places) {
    rows.push_back({std::lround(mm_from_metres(place.x())), std::lround(mm_from_metres(place.y())),
                    std::lround(mm_from_metres(place.z()))});
  }
  return rows;
}

std::vector<Eigen::Vector3d> to_places(const JsonValue& rows) {
  std::vector<Eigen::Vector3d> places;
  for (const JsonValue& row : rows.elements()) {
    const std::vector<JsonValue> place = row.elements(3);
    places.emplace_back(metres_from_mm(place[0].number()), metres_from_mm(place[1].number()),
                        metres_from_mm(place[2].number()));
  }
  return places;
}

Verdict to_verdict(const JsonValue& name) {
  const std::string text = name.text();
  const auto* const found = std::ranges::find(
      verdicts, text, [](Verdict verdict) { return std::string(to_string(verdict)); });
  if (found == verdicts.end()) {
    name.refuse("a verdict that this version knows");
  }
  return *found;
}

}  // namespace

json to_json(const Quality& quality) {
  json reasons = json::array();
  for (const QualityReason& reason : quality.reasons) {
    reasons.push_back({{"code", reason.code}, {"detail", reason.detail}, {"hint", reason.hint}});
    if (!reason.parameters.empty()) {
      reasons.back()["parameters"] = to_json(reason.parameters);
    }
    if (!reason.places.empty()) {
      reasons.back()["places_mm"] = to_places_mm(reason.places);
    }
  }
  json object{{"verdict", to_string(quality.verdict)}, {"reasons", reasons}};
  if (quality.size_error) {
    object["size_error"] = {{"mm", mm_from_metres(quality.size_error->error)},
                            {"of_mm", mm_from_metres(quality.size_error->length)}};
  }
  return object;
}

Quality to_quality(const JsonValue& object) {
  JsonObject keys(object);
  Quality quality{.verdict = to_verdict(keys.at("verdict"))};
  for (const JsonValue& reason : keys.at("reasons").elements()) {
    JsonObject of_reason(reason);
    const auto places = of_reason.value("places_mm");
    quality.reasons.push_back(
        {.code = of_reason.at("code").text(),
         .detail = of_reason.at("detail").text(),
         .hint = of_reason.at("hint").text(),
         .parameters = to_parameters(of_reason.value("parameters")),
         .places = places ? to_places(*places) : std::vector<Eigen::Vector3d>{}});
  }
  if (const auto size = keys.value("size_error")) {
    JsonObject of_size(*size);
    quality.size_error = SizeError{.length = metres_from_mm(of_size.at("of_mm").number()),
                                   .error = metres_from_mm(of_size.at("mm").number())};
  }
  return quality;
}

}  // namespace octurn
