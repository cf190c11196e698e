#pragma once

#include <stop_token>
#include <variant>

#include "octurn/intersection.hpp"
#include "octurn/reconstruct_options.hpp"
#include "octurn/solid.hpp"

namespace octurn {

/// A model in the making, by the method that the options name: snapshots are added, then its
/// surface is asked for. Each of the methods has the same members.
class Reconstruction {
 public:
  /// @throws Error "bad-settings"  that says which option is out of its range
  /// @throws Error "memory-limit"  that says what limit would do
  explicit Reconstruction(const ReconstructOptions& options);

  /// @throws Error "memory-limit"  if not even a part of what was seen fits
  void add(const Snapshot& snapshot);

  /// The same for all of them, on as many threads as the options say. Ends early if stopped.
  void add(const SnapshotSource& snapshots, const std::stop_token& stop = {});

  /// The surface, streamed. What `sink` throws ends it.
  /// @param snapshots  those that were added, to be read again if not all fitted in memory
  /// @throws Error "memory-limit"  if it needs more
  SurfaceCount surface(const SnapshotSource& snapshots, const FacetSink& sink);

  /// What `surface` would give.
  SurfaceCount count(const SnapshotSource& snapshots);

  /// The surface of what was seen so far, on the first level whose nodes are at or below
  /// `leaf_size` (metres), or on the finest above it that has no more than `most_facets`. Of
  /// several slabs it shows the one at hand.
  void preview(double leaf_size, std::uint64_t most_facets, const FacetSink& sink) const;

 private:
  std::variant<Intersection, Solid> method_;
};

}  // namespace octurn
