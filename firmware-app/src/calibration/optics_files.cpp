#include "calibration/optics_files.hpp"

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>
#include <utility>

#include "calibration/record_file.hpp"
#include "calibration/sensor_map_files.hpp"
#include "octurn/error.hpp"
#include "octurn/json_object.hpp"
#include "octurn/optics_json.hpp"

namespace octurn {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr std::string_view optics_format = "octurn-optics";
constexpr std::size_t max_optics_bytes = std::size_t{1} << 18U;  // 30 times the usual size

using OpticsName = std::pair<OpticsOrigin, std::string_view>;

constexpr std::array<OpticsName, 3> optics_names{
    {{OpticsOrigin::turn, "turn"}, {OpticsOrigin::scan, "scan"}, {OpticsOrigin::board, "board"}}};

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

std::vector<OpticsRecord> optics_records_from(JsonObject& root) {
  std::vector<OpticsRecord> records;
  for (const JsonValue& record : root.at("records").elements()) {
    records.push_back(to_optics_record(record));
  }
  return records;
}

/// Writes the newest records. The newest one by a board is among them, however many follow it.
/// @param records  newest first
void write_optics(const fs::path& data, std::string_view serial,
                  std::vector<OpticsRecord> records) {
  while (records.size() > max_optics_history + 1) {
    const auto board = std::ranges::find(records, OpticsOrigin::board, &OpticsRecord::origin);
    records.erase(records.end() - (records.end() - 1 == board ? 2 : 1));
  }
  json list = json::array();
  for (const OpticsRecord& record : records) {
    list.push_back(to_json(record));
  }
  write_record_file(optics_path(data, serial), optics_format,
                    {{"serial", serial}, {"records", list}});
}

}  // namespace

fs::path optics_path(const fs::path& data, std::string_view serial) {
  return data / "optics" / sensor_map_path(data, serial).filename().replace_extension(".json");
}

std::vector<OpticsRecord> read_optics(const fs::path& data, std::string_view serial) {
  if (serial.empty()) {
    return {};
  }
  return read_record({.file = optics_path(data, serial),
                      .format = optics_format,
                      .max_bytes = max_optics_bytes,
                      .malformed = ErrorCode::platform_malformed},
                     optics_records_from)
      .value_or(std::vector<OpticsRecord>());
}

std::vector<OpticsRecord> last_good_optics(const fs::path& data, std::string_view serial) {
  return last_good([&] { return read_optics(data, serial); }).value_or(std::vector<OpticsRecord>());
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

std::optional<OpticsRecord> optics_record(const fs::path& data, std::string_view serial) {
  const std::vector<OpticsRecord> records = last_good_optics(data, serial);
  return records.empty() ? std::nullopt : std::optional(records.front());
}

std::optional<SensorOptics> optics_in_force(const fs::path& data, std::string_view serial) {
  const auto record = optics_record(data, serial);
  return record ? std::optional(record->optics.value) : std::nullopt;
}

json to_json(const OpticsRecord& record) {
  json object = to_json(record.optics);
  object["source"] = std::ranges::find(optics_names, record.origin, &OpticsName::first)->second;
  object["at"] = record.at;
  return object;
}

}  // namespace octurn
