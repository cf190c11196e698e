#pragma once

#include <optional>
#include <vector>

#include "octurn/model.hpp"
#include "octurn/quality.hpp"

namespace octurn {

/// What the sensor saw of the object and a model has no surface near.
struct MissingPart {
  double length = 0;                         ///< metres, the longest side of its box
  std::vector<Eigen::Vector3d> places = {};  ///< metres, as those of a `QualityReason`
};

/// The largest part of what several stops saw that is missing from a model. What is nearer to the
/// model than noise and voxels can be is not missing, nor is a speck.
std::optional<MissingPart> find_missing_part(const ScanFigures& scan, const ModelReport& model);

}  // namespace octurn
