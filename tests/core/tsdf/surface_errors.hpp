#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <vector>

#include "core/tsdf/rendered.hpp"
#include "octurn/stl.hpp"
#include "octurn/units.hpp"
#include "tsdf/solid_reconstructor.hpp"

namespace octurn {

/// Area-weighted distances of the observed surface from the true one, millimetres.
struct Errors {
  double mean = 0;
  double p95 = 0;
};

inline Errors errors_of(const std::vector<Facet>& facets, const Shape& truth) {
  struct Part {
    double error = 0;
    double area = 0;
  };
  std::vector<Part> parts;
  double whole = 0;
  Errors errors;
  for (const Facet& facet : facets) {
    const auto corners = facet.corners;
    const Eigen::Vector3d a = Eigen::Vector3f(corners[0].data()).cast<double>();
    const Eigen::Vector3d b = Eigen::Vector3f(corners[1].data()).cast<double>();
    const Eigen::Vector3d c = Eigen::Vector3f(corners[2].data()).cast<double>();
    const Eigen::Vector3d middle = (a + b + c) / 3;
    if (facet.attributes == filled_in || middle.z() < 6) {  // mm; the clip box begins at 5
      continue;
    }
    const Part part{.error = std::abs(mm_from_metres(truth(middle / 1000))),
                    .area = (b - a).cross(c - a).norm() / 2};
    parts.push_back(part);
    whole += part.area;
    errors.mean += part.error * part.area;
  }
  errors.mean /= whole;
  std::ranges::sort(parts, {}, &Part::error);
  double below = 0;
  for (const Part& part : parts) {
    below += part.area;
    if (below >= 0.95 * whole) {
      errors.p95 = part.error;
      break;
    }
  }
  return errors;
}

}  // namespace octurn
