#include "scan/quality_json.hpp"

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>
#include <string>

namespace octurn {
namespace {

using nlohmann::json;

constexpr std::array verdicts{Verdict::good, Verdict::look, Verdict::bad};

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
  }
  return {{"verdict", to_string(quality.verdict)}, {"reasons", reasons}};
}

Quality to_quality(const JsonValue& object) {
  JsonObject keys(object);
  Quality quality{.verdict = to_verdict(keys.at("verdict"))};
  for (const JsonValue& reason : keys.at("reasons").elements()) {
    JsonObject of_reason(reason);
    quality.reasons.push_back({.code = of_reason.at("code").text(),
                               .detail = of_reason.at("detail").text(),
                               .hint = of_reason.at("hint").text()});
  }
  return quality;
}

}  // namespace octurn
