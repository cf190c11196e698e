#pragma once

#include <optional>
#include <vector>

#include "octurn/quality.hpp"
#include "octurn/reconstruct.hpp"

namespace octurn {

/// A part of the object that was seen but has no model surface near.
struct MissingPart {
  double length = 0;                         ///< metres, the longest side of its box
  std::vector<Eigen::Vector3d> places = {};  ///< metres, object's frame
};

/// Finds the largest part that several stops saw and a model lacks. Points within noise and voxel
/// size of the model are not missing, and specks do not count.
std::optional<MissingPart> find_missing_part(const ScanFigures& scan, const ModelReport& model);

/// Metres, the side of a model's voxels or leaves. @return 0 for a model without any
double voxel_side(const ModelReport& model);

}  // namespace octurn
