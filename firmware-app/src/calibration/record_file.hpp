#pragma once

#include <filesystem>
#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string_view>

#include "log.hpp"
#include "octurn/error.hpp"
#include "octurn/json_object.hpp"

namespace octurn {

/// A JSON file of the calibration, with the keys "format" and "version", which is 1.
struct RecordFile {
  std::filesystem::path file = {};
  std::string_view format = {};
  std::size_t max_bytes = 0;
  ErrorCode malformed = ErrorCode::platform_malformed;  ///< of the errors of a damaged file
};

/// Reads a file, and calls `parse` with its keys unless it does not exist.
/// @throws Error  `malformed` with the file's name, also of another format; "read-failed"
void read_record_file(const RecordFile& file, const std::function<void(JsonObject& root)>& parse);

/// Returns what `parse` makes of a file's keys; nullopt if it does not exist. @throws Error  as
/// above
template <typename Record>
std::optional<Record> read_record(const RecordFile& file, Record (*parse)(JsonObject& root)) {
  std::optional<Record> record;
  read_record_file(file, [&](JsonObject& root) { record = parse(root); });
  return record;
}

/// What `read` returns; nullopt, with a line in the log, if it throws an `Error`.
template <typename Read>
auto last_good(Read read) -> std::optional<decltype(read())> try {
  return read();
} catch (const Error& error) {
  log::warning("calibration", error.what());
  return std::nullopt;
}

/// Writes a file whole or not at all, and its folder if there is none.
/// @throws Error "disk-full", "write-failed"
void write_record_file(const std::filesystem::path& file, std::string_view format,
                       nlohmann::json document);

}  // namespace octurn
