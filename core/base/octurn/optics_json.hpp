#pragma once

#include <nlohmann/json_fwd.hpp>

#include "octurn/json_object.hpp"
#include "octurn/snapshot.hpp"

namespace octurn {

/// The JSON of a sensor's optics: fx, fy, cx, cy, k1, k2, depth_scale and depth_offset_per_m.
nlohmann::json to_json(const SensorOptics& optics);
/// @throws Error  that names a key that is missing or out of its bounds
SensorOptics optics_from(const JsonValue& object);

/// The same, with "sigma": an object of the same keys.
nlohmann::json to_json(const SolvedOptics& optics);
/// @throws Error  as above
SolvedOptics solved_optics_from(const JsonValue& object);

}  // namespace octurn
