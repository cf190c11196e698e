#include "doctor/finding.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <nlohmann/json.hpp>
#include <utility>

#include "octurn/units.hpp"
#include "version.hpp"
#include "wall_clock.hpp"

namespace octurn {
namespace {

using nlohmann::json;

Finding finding(const Check& check, Finding::State state, std::string measured, std::string advice,
                Action action) {
  return {.check = std::string(check.id),
          .name = std::string(check.name),
          .state = state,
          .measured = std::move(measured),
          .advice = std::move(advice),
          .action = action};
}

}  // namespace

Finding Check::ok(std::string measured) const {
  return finding(*this, Finding::State::ok, std::move(measured), {}, Action::none);
}

Finding Check::warning(std::string measured, std::string advice, Action action) const {
  return finding(*this, Finding::State::warning, std::move(measured), std::move(advice), action);
}

Finding Check::fault(std::string measured, std::string advice, Action action) const {
  return finding(*this, Finding::State::fault, std::move(measured), std::move(advice), action);
}

Finding Check::unknown(std::string measured, std::string advice) const {
  return finding(*this, Finding::State::unknown, std::move(measured), std::move(advice),
                 Action::none);
}

std::string_view to_string(Finding::State state) {
  constexpr std::array<std::string_view, 4> names{"ok", "warning", "fault", "unknown"};
  return names[static_cast<std::size_t>(state)];
}

std::string_view to_string(Action action) {
  constexpr std::array<std::string_view, 5> names{"", "measure-turn", "set-pose", "open-settings",
                                                  "choose-scans"};
  return names.at(static_cast<std::size_t>(action));
}

Finding::State overall_state(std::span<const Finding> findings) {
  for (const auto state : {Finding::State::fault, Finding::State::warning}) {
    if (std::ranges::find(findings, state, &Finding::state) != findings.end()) {
      return state;
    }
  }
  return Finding::State::ok;
}

std::string rounded(double value, int digits) {
  std::array<char, 64> text{};
  const auto end = std::to_chars(text.data(), text.data() + text.size(), value,
                                 std::chars_format::fixed, digits);
  const std::string_view number(text.data(), static_cast<std::size_t>(end.ptr - text.data()));
  const bool is_zero = number.find_first_not_of("-0.") == number.npos;
  return std::string(number.substr(is_zero && number.starts_with('-') ? 1 : 0));
}

std::string readable_bytes(double bytes) {
  const double gb = decimal_gb_from_bytes(bytes);
  return gb < 1 ? rounded(decimal_mb_from_bytes(bytes), 0) + " MB" : rounded(gb, 1) + " GB";
}

json to_json(std::span<const Finding> findings) {
  json all = json::array();
  for (const Finding& finding : findings) {
    all.push_back({{"check", finding.check},
                   {"name", finding.name},
                   {"state", to_string(finding.state)},
                   {"measured", finding.measured},
                   {"advice", finding.advice},
                   {"action", to_string(finding.action)}});
  }
  return {{"version", version()},
          {"time", utc_text(std::chrono::system_clock::now(), rfc3339)},
          {"state", to_string(overall_state(findings))},
          {"findings", std::move(all)}};
}

}  // namespace octurn
