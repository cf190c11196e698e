// ScanStore: the platform's angle.

#include <nlohmann/json.hpp>

#include "log.hpp"
#include "octurn/file.hpp"
#include "octurn/json_object.hpp"
#include "store/json_numbers.hpp"
#include "store/scan_store.hpp"

namespace octurn {
namespace {

using nlohmann::json;

constexpr std::size_t max_platform_bytes = 4096;

}  // namespace

double ScanStore::platform_angle_deg() const {
  try {
    const json document =
        parse_json(read_regular_file(platform_, max_platform_bytes).value_or("{}"),
                   ErrorCode::platform_malformed, platform_.string());
    return JsonObject(document, ErrorCode::platform_malformed, "")
        .number("angle_deg", -unlimited, unlimited)
        .value_or(0);
  } catch (const Error& error) {
    log::warning("store", error.what());
    return 0;  // the angle before the first move
  }
}

void ScanStore::save_platform_angle_deg(double angle_deg) const {
  write_file(platform_, json{{"angle_deg", angle_deg}}.dump() + "\n");
}

}  // namespace octurn
