#include <nlohmann/json.hpp>

#include "io/sensor_json.hpp"
#include "octurn/calibrate.hpp"
#include "octurn/error.hpp"
#include "octurn/file.hpp"
#include "octurn/json_object.hpp"
#include "octurn/scan_folder.hpp"
#include "octurn/units.hpp"

namespace octurn {
namespace {

using nlohmann::json;

constexpr const char* last_look_key = "last_look";

/// Reads the scan.json of a folder, and checks that it is a scan's. @throws Error  as `read_scan`
json read_document(const std::filesystem::path& folder) {
  const std::string text =
      read_bytes(folder / "scan.json", ErrorCode::scan_missing,
                 "Name a folder that holds a whole scan.", ErrorCode::scan_malformed);
  parse_scan(text);
  return parse_json(text, ErrorCode::scan_malformed, "scan.json");
}

}  // namespace

void write_object_move(const std::filesystem::path& folder, const ObjectMove& move) {
  json document = read_document(folder);
  document[last_look_key] = {{"moved_mm", mm_from_metres(move.shift)},
                             {"moved_sigma_mm", mm_from_metres(move.shift_sigma)},
                             {"turned_deg", degrees_from_radians(move.turn)},
                             {"turned_sigma_deg", degrees_from_radians(move.turn_sigma)}};
  write_file(folder / "scan.json", document.dump(1) + "\n");
}

std::optional<ObjectMove> read_object_move(const std::filesystem::path& folder) {
  const json document = read_document(folder);
  JsonObject root(document, ErrorCode::scan_malformed, "");
  const auto last_look = root.value(last_look_key);
  if (!last_look) {
    return std::nullopt;
  }
  JsonObject keys(*last_look);
  return ObjectMove{.shift = metres_from_mm(keys.at("moved_mm").number()),
                    .shift_sigma = metres_from_mm(keys.at("moved_sigma_mm").number()),
                    .turn = radians_from_degrees(keys.at("turned_deg").number()),
                    .turn_sigma = radians_from_degrees(keys.at("turned_sigma_deg").number())};
}

}  // namespace octurn
