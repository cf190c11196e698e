#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string_view>

#include "octurn/box.hpp"
#include "octurn/snapshot.hpp"

namespace octurn {

/// What becomes of snapshots.
enum class Method {
  intersection,  ///< every leaf that something was seen in, hollow (Bennett 2014)
  solid,         ///< one closed part, averaged and filled, on a flat foot
};

/// Its name in settings and files: "intersection", "solid".
std::string_view name_of(Method method);

/// The method of that name, if there is one.
std::optional<Method> method_named(std::string_view name);

/// How snapshots become a model.
struct ReconstructOptions {
  Method method = Method::intersection;
  double leaf_size = 0.001;   ///< metres: leaves are the first level at or below it
  double root_size = 1.0;     ///< metres, side of the root cube
  double threshold = 0.0001;  ///< intersection: square metres: triangles with a longer side,
                              ///< squared, are none
  Box clip = {};              ///< metres, platform frame
  std::optional<int> level =
      {};                      ///< intersection: surface of this coarser level, the root's being 0
  double max_error = 0.00004;  ///< solid: metres that fewer triangles may cost; 0 keeps them all
  int threads = 1;             ///< the model's bytes do not depend on it
  std::size_t memory_limit = 0;  ///< bytes that the whole process may take; 0 is no limit
};

/// The number of levels that the options ask for, if what all methods need is in its range.
/// @throws Error "bad-settings"  that says which option is out of its range
int checked_levels(const ReconstructOptions& options);

/// Snapshots that can be read, and read again, by several threads at once.
struct SnapshotSource {
  std::size_t count = 0;
  std::function<Snapshot(std::size_t)> read = {};
};

/// The size of a surface.
struct SurfaceCount {
  std::uint64_t leaves = 0;
  std::uint64_t facets = 0;
  std::uint64_t parts = 0;  ///< 0: not counted
};

}  // namespace octurn
