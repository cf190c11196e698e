#include "calibration/optics_files.hpp"

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>
#include <system_error>
#include <utility>

#include "calibration/sensor_map_files.hpp"
#include "log.hpp"
#include "octurn/error.hpp"
#include "octurn/file.hpp"
#include "octurn/json_object.hpp"
#include "octurn/optics_json.hpp"

namespace octurn {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr std::size_t max_optics_bytes = std::size_t{1} << 18U;  // 30 times the usual size

using OpticsName = std::pair<OpticsOrigin, std::string_view>;

constexpr std::array<OpticsName, 2> optics_names{
    {{OpticsOrigin::turn, "turn"}, {OpticsOrigin::scan, "scan"}}};

OpticsRecord to_optics_record(const JsonValue& object) {
  JsonObject keys(object);
  const JsonValue source = keys.at("source");
  const auto* const origin = std::ranges::find(optics_names, source.text(), &OpticsName::second);
  if (origin == optics_names.end()) {
    source.refuse("a name that this version knows");
  }
  return {
      .optics = solved_optics_from(object), .origin = origin->first, .at = keys.at("at").text()};
}

std::vector<OpticsRecord> optics_records_from(const json& document) {
  JsonObject root(document, ErrorCode::platform_malformed, "");
  if (const JsonValue format = root.at("format"); format.text() != "octurn-optics") {
    format.refuse("\"octurn-optics\"");
  }
  if (const JsonValue version = root.at("version"); version.number() != 1) {
    version.refuse("1, which this program reads");
  }
  std::vector<OpticsRecord> records;
  for (const JsonValue& record : root.at("records").elements()) {
    records.push_back(to_optics_record(record));
  }
  return records;
}

std::vector<OpticsRecord> last_good_optics(const fs::path& data, std::string_view serial) {
  try {
    return read_optics(data, serial);
  } catch (const Error& error) {
    log::warning("calibration", error.what());
    return {};
  }
}

/// @param records  newest first
void write_optics(const fs::path& data, std::string_view serial,
                  std::vector<OpticsRecord> records) {
  records.resize(std::min(records.size(), max_optics_history + 1));
  json list = json::array();
  for (const OpticsRecord& record : records) {
    list.push_back(to_json(record));
  }
  const fs::path file = optics_path(data, serial);
  std::error_code failed;
  fs::create_directories(file.parent_path(), failed);
  if (failed) {
    throw Error(ErrorCode::write_failed, file.string() + ": cannot be written: " + failed.message(),
                "Look at the disk.");
  }
  write_file(
      file,
      json{{"format", "octurn-optics"}, {"version", 1}, {"serial", serial}, {"records", list}}.dump(
          1, ' ', false, json::error_handler_t::replace) +
          "\n");
}

}  // namespace

fs::path optics_path(const fs::path& data, std::string_view serial) {
  return data / "optics" / sensor_map_path(data, serial).filename().replace_extension(".json");
}

std::vector<OpticsRecord> read_optics(const fs::path& data, std::string_view serial) {
  if (serial.empty()) {
    return {};
  }
  const fs::path file = optics_path(data, serial);
  const auto text = read_regular_file(file, max_optics_bytes);
  try {
    return text ? optics_records_from(parse_json(*text, ErrorCode::platform_malformed, "it"))
                : std::vector<OpticsRecord>{};
  } catch (const Error& error) {
    throw Error(error.code(), file.string() + ": " + error.what(), error.hint());
  }
}

void keep_optics(const fs::path& data, std::string_view serial, const OpticsRecord& record) {
  std::vector<OpticsRecord> records = last_good_optics(data, serial);
  records.insert(records.begin(), record);
  write_optics(data, serial, std::move(records));
}

void undo_optics(const fs::path& data, std::string_view serial) {
  std::vector<OpticsRecord> records = read_optics(data, serial);
  if (records.empty()) {
    throw Error(ErrorCode::not_found, "no measured optics of this sensor are kept",
                "Those that the sensor reports are in force.");
  }
  records.erase(records.begin());
  write_optics(data, serial, std::move(records));
}

std::optional<SensorOptics> optics_in_force(const fs::path& data, std::string_view serial) {
  const std::vector<OpticsRecord> records = last_good_optics(data, serial);
  return records.empty() ? std::nullopt : std::optional(records.front().optics.value);
}

json to_json(const OpticsRecord& record) {
  json object = to_json(record.optics);
  object["source"] = std::ranges::find(optics_names, record.origin, &OpticsName::first)->second;
  object["at"] = record.at;
  return object;
}

}  // namespace octurn
