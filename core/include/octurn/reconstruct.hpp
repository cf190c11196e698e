#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <stop_token>
#include <string_view>
#include <vector>

#include "octurn/snapshot.hpp"
#include "octurn/stl.hpp"

namespace octurn {

/// Largest number of times that the root cube is halved.
inline constexpr int max_levels = 16;

/// How snapshots become a mesh.
enum class Method {
  /// Voxel octree intersection (Bennett 2014): neighbouring samples make triangles, every octree
  /// leaf that one meets is occupied, marching tetrahedra draw the surface of the leaves. The mesh
  /// is closed and hollow, at least a leaf thick, outliers included.
  intersection,
  /// Truncated signed distances (Curless and Levoy 1996): conditioned depth is integrated into a
  /// TSDF, holes are filled by Laplace's equation, one connected component is kept, marching cubes
  /// and edge collapse (QEM) draw it. The mesh is one closed solid on a flat base.
  solid,
};

/// The method's name in settings and files: "intersection", "solid".
std::string_view to_string(Method method);

/// The method of that name, if there is one.
std::optional<Method> method_named(std::string_view name);

/// Which connected components the method `solid` keeps.
enum class Parts {
  main,  ///< the object
  all,   ///< all that stand on the platform
};

/// The choice's name in settings: "main", "all".
std::string_view to_string(Parts parts);

/// Options of the method `solid`, beside the error that its simplifier may make.
struct SolidOptions {
  /// Metres, how far before and behind a surface distances to it count; at least 2.5 voxels. 3
  /// sigma of the sensor's noise: the default is a Kinect v1's at 0.65 m.
  double truncation = 0.0035;

  /// Of several poses one is kept: what was turned over is one object.
  Parts parts = Parts::main;
};

/// Options of both methods, but where one is named.
struct ReconstructOptions {
  Method method = Method::intersection;

  /// Metres. Leaves (voxels for `solid`) are the root cube halved until their side is at or below
  /// it.
  double leaf_size = 0.001;

  /// Metres, side of the root cube, which stands on the platform: x, y from -side/2 to side/2, z
  /// from 0 to side.
  double root_size = 1.0;

  /// `intersection` only: square metres. A triangle with a longer side, squared, is dropped, as it
  /// bridges a gap between surfaces.
  double threshold = 0.0001;

  /// Metres, object's frame. Samples outside make no surface.
  Box clip = {};

  /// How the object lay in each of several poses, by `Snapshot::pose`; empty for one pose, in which
  /// the object's frame is the platform's. Of a pose, samples outside its own clip box make no
  /// surface either, nor do those of its platform.
  std::vector<Placement> placements = {};

  /// `intersection` only: the level whose nodes the surface is drawn of, 0 for the root. The level
  /// of the leaves if absent.
  std::optional<int> level = {};

  /// `solid` only: metres, the root mean square distance that a vertex may have from the planes of
  /// the triangles that it replaces; from a single one it may be farther. 0 keeps all triangles.
  double target_error = 0.00004;

  SolidOptions solid = {};

  /// At least 1. The model's bytes do not depend on it.
  int threads = 1;

  /// Bytes that the reconstruction and the program around it may take; 0 is no limit. The model's
  /// bytes do not depend on it.
  std::size_t memory_limit = 0;

  /// Bytes of the limit that the program takes, with its libraries: the caller knows them.
  std::size_t program_memory = 0;
};

/// `SolidOptions::truncation` of scans by laser line, metres. Their points have a sigma of 0.05 to
/// 0.2 mm, but lines are a millimetre or two apart, and behind the surface the field must be known
/// for as far to tell inside from outside.
inline constexpr double laser_truncation = 0.002;

/// What memory a model takes.
struct MemoryNeed {
  std::size_t bytes = 0;         ///< of the whole process
  double fitting_leaf_size = 0;  ///< metres: the options', doubled until it fits in their limit
};

/// What the method `solid` takes, as far as clip box and leaves tell, for an object of 10 cm.
/// @throws Error "bad-settings"  that says which option is out of its range
MemoryNeed expected_memory(const ReconstructOptions& options);

/// The size of a surface.
struct SurfaceCount {
  std::uint64_t leaves = 0;  ///< occupied leaves, or voxels inside
  std::uint64_t facets = 0;
  std::uint64_t parts = 0;           ///< connected components; 0: not counted
  std::uint64_t dropped_parts = 0;   ///< components that are not in the model
  std::uint64_t dropped_leaves = 0;  ///< their voxels
};

/// A reconstruction in progress: snapshots are added, then its surface is asked for. Not
/// thread-safe; a call forks and joins the threads of the options inside itself.
///
/// Deterministic: the same snapshots in the same order give the same bytes on x86-64 and arm64, for
/// any number of threads and any memory limit.
///
/// Each call looks at its stop token in every phase, and throws `Stopped` within a fraction of a
/// second's work after a stop was requested. The reconstruction is then incomplete: it can only be
/// destroyed.
class Reconstructor {
 public:
  Reconstructor() = default;
  virtual ~Reconstructor() = default;
  Reconstructor(const Reconstructor&) = delete;
  Reconstructor& operator=(const Reconstructor&) = delete;

  /// Adds one snapshot.
  /// @throws Error "memory-limit"   if not even one layer of what was observed fits
  /// @throws std::invalid_argument  if the frame's size is not that of the intrinsics
  virtual void add(const Snapshot& snapshot, const std::stop_token& stop = {}) = 0;

  /// Adds all snapshots of a source, on as many threads as the options say.
  /// @throws  as above, and what the source throws
  virtual void add(const SnapshotSource& snapshots, const std::stop_token& stop = {}) = 0;

  /// Streams the surface of all that was added.
  ///
  /// @param snapshots  those that were added; read again where the volume exceeds the memory limit
  ///                   and is built slab by slab
  /// @param sink       called by one thread at a time; what it throws ends the call
  /// @throws Error "memory-limit"  if more memory is needed
  virtual SurfaceCount surface(const SnapshotSource& snapshots, const FacetSink& sink,
                               const std::stop_token& stop = {}) = 0;

  /// Counts what `surface` would give. @throws  as `surface`
  virtual SurfaceCount count(const SnapshotSource& snapshots, const std::stop_token& stop = {}) = 0;

  /// Streams a coarse surface of what was added so far: of the first level whose nodes are at or
  /// below `leaf_size` (metres), or of the finest above it that has no more than `max_facets`.
  /// Where the volume is built in slabs, it shows the one in memory.
  virtual void preview(double leaf_size, std::uint64_t max_facets, const FacetSink& sink,
                       const std::stop_token& stop = {}) const = 0;
};

/// A reconstruction by the method that the options name.
///
/// @throws Error "bad-settings"  that says which option is out of its range
/// @throws Error "memory-limit"  that says what limit would do
std::unique_ptr<Reconstructor> make_reconstructor(const ReconstructOptions& options);

}  // namespace octurn
