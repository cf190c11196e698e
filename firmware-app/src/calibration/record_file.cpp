#include "calibration/record_file.hpp"

#include <nlohmann/json.hpp>
#include <string>
#include <system_error>

#include "octurn/file.hpp"

namespace octurn {

void read_record_file(const RecordFile& file, const std::function<void(JsonObject& root)>& parse) {
  const auto text = read_regular_file(file.file, file.max_bytes);
  if (!text) {
    return;
  }
  try {
    const nlohmann::json document = parse_json(*text, file.malformed, "it");
    JsonObject root(document, file.malformed, "");
    if (const JsonValue format = root.at("format"); format.text() != file.format) {
      format.refuse("\"" + std::string(file.format) + "\"");
    }
    if (const JsonValue version = root.at("version"); version.number() != 1) {
      version.refuse("1, which this program reads");
    }
    parse(root);
  } catch (const Error& error) {
    throw Error(error.code(), file.file.string() + ": " + error.what(), error.hint());
  }
}

void write_record_file(const std::filesystem::path& file, std::string_view format,
                       nlohmann::json document) {
  std::error_code failed;
  std::filesystem::create_directories(file.parent_path(), failed);
  if (failed) {
    throw Error(ErrorCode::write_failed, file.string() + ": cannot be written: " + failed.message(),
                "Look at the disk.");
  }
  document["format"] = format;
  document["version"] = 1;
  write_file(file, document.dump(1, ' ', false, nlohmann::json::error_handler_t::replace) + "\n");
}

}  // namespace octurn
