#pragma once

#include <nlohmann/json_fwd.hpp>
#include <vector>

#include "octurn/json_object.hpp"
#include "octurn/scan_folder.hpp"

namespace octurn {

/// Names and planes of lasers, as files, `--json` and the API have them.
nlohmann::json planes_to_json(const std::vector<Laser>& lasers);

/// The lasers of such JSON, without their sources. @throws Error  of the value's code
std::vector<Laser> to_planes(const JsonValue& list);

}  // namespace octurn
