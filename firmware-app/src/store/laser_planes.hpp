#pragma once

#include <nlohmann/json_fwd.hpp>
#include <vector>

#include "octurn/json_object.hpp"
#include "octurn/scan_folder.hpp"

namespace octurn {

/// JSON of the lasers' names and planes, for files, `--json` and the API.
nlohmann::json planes_to_json(const std::vector<Laser>& lasers);

/// Parses that JSON to lasers without `source`. @throws Error  with the code of `list`
std::vector<Laser> to_planes(const JsonValue& list);

}  // namespace octurn
