#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <stop_token>
#include <string_view>

#include "octurn/box.hpp"
#include "octurn/facet.hpp"
#include "octurn/snapshot.hpp"

namespace octurn {

/// Largest number of times that the root cube is halved.
inline constexpr int max_levels = 16;

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

/// A reconstruction in progress: snapshots are added, then its surface is asked for.
class Reconstructor {
 public:
  Reconstructor() = default;
  virtual ~Reconstructor() = default;
  Reconstructor(const Reconstructor&) = delete;
  Reconstructor& operator=(const Reconstructor&) = delete;

  /// @throws Error "memory-limit"  if not even a part of what was seen fits
  virtual void add(const Snapshot& snapshot) = 0;

  /// The same for all of them, on as many threads as the options say. Ends early if stopped.
  virtual void add(const SnapshotSource& snapshots, const std::stop_token& stop = {}) = 0;

  /// The surface, streamed. What `sink` throws ends it.
  /// @param snapshots  those that were added, to be read again if not all fitted in memory
  /// @throws Error "memory-limit"  if it needs more
  virtual SurfaceCount surface(const SnapshotSource& snapshots, const FacetSink& sink) = 0;

  /// What `surface` would give.
  virtual SurfaceCount count(const SnapshotSource& snapshots) = 0;

  /// The surface of what was seen so far, on the first level whose nodes are at or below
  /// `leaf_size` (metres), or on the finest above it that has no more than `max_facets`. Of
  /// several slabs it shows the one at hand.
  virtual void preview(double leaf_size, std::uint64_t max_facets, const FacetSink& sink) const = 0;
};

/// A reconstruction by the method that the options name.
/// @throws Error "bad-settings"  that says which option is out of its range
/// @throws Error "memory-limit"  that says what limit would do
std::unique_ptr<Reconstructor> make_reconstructor(const ReconstructOptions& options);

}  // namespace octurn
