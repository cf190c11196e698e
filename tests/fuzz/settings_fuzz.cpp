#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <string_view>

#include "commands/commands.hpp"
#include "config/config_store.hpp"
#include "fuzz/small_models.hpp"
#include "octurn/file.hpp"
#include "support/temporary_folder.hpp"

// The way of settings to the daemon. A settings.json of any text gives a configuration, and what a
// request may change in it is there after a restart. Of any lines KEY=VALUE, which octurn.txt
// gives, `octurn set` writes an octurn.json that can be read, or changes nothing. All errors are of
// one line.
//
// An input is the text of settings.json, a byte 0, and those lines.

namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using octurn::require;
using octurn::require_one_line;

void check_settings(const fs::path& data, std::string_view text) {
  octurn::put(data / "settings.json", text);
  octurn::ConfigLayers layers;
  layers.file.data = data;
  octurn::ConfigStore store(layers);
  require(store.trouble().find('\n') == std::string::npos);
  try {
    store.change({{"scan", {{"frames", 3}}}});
  } catch (const octurn::Error& error) {
    require_one_line(error);
    return;
  }
  require(store.config().scan.frames == 3);
  const octurn::ConfigStore next(layers);
  require(next.trouble().empty());
  require(next.stored() == store.stored());
}

void check_lines(const fs::path& file, const std::string& text) {
  constexpr const char* before = "{\"threads\": 2}";
  octurn::put(file, before);
  octurn::SetArguments arguments{.file = file};
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    arguments.assignments.push_back(line);
  }
  try {
    octurn::set(arguments);
  } catch (const octurn::Error& error) {
    require_one_line(error);
    require(octurn::content_of(file) == before);
    return;
  }
  const std::string written = octurn::content_of(file);
  octurn::with_settings({}, json::parse(written));
  octurn::set({.file = file});
  require(octurn::content_of(file) == written);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const octurn::TemporaryFolder folder;
  const std::string_view input(reinterpret_cast<const char*>(data), size);
  const std::size_t end = std::min(input.find('\0'), input.size());
  check_settings(folder.path(), input.substr(0, end));
  check_lines(folder.path() / "octurn.json",
              std::string(input.substr(std::min(end + 1, input.size()))));
  return 0;
}
