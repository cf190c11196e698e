#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
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

/// Maximum number of octree levels below the root cube.
inline constexpr int max_levels = 16;

/// How snapshots become a mesh.
enum class Method {
  /// Voxel octree intersection (Bennett 2014): neighbouring samples make triangles, every octree
  /// leaf that a triangle meets is occupied, marching tetrahedra draw the surface of the leaves.
  /// The mesh is closed and hollow, at least a leaf thick, and includes outliers.
  intersection,
  /// Truncated signed distances (Curless and Levoy 1996): conditioned depth is integrated into a
  /// TSDF, holes are filled by Laplace's equation, one connected component is kept, marching cubes
  /// draw its isosurface and edge collapse (QEM) simplifies it. The mesh is one closed solid on a
  /// flat base.
  solid,
};

/// The method's name in settings and files: "intersection", "solid".
std::string_view to_string(Method method);

/// The method of that name, if there is one.
std::optional<Method> method_named(std::string_view name);

/// Which connected components the method `solid` keeps.
enum class Parts {
  main,  ///< the object
  all,   ///< every one that stands on the platform
};

/// The choice's name in settings: "main", "all".
std::string_view to_string(Parts parts);

/// Options of the method `solid`, besides `ReconstructOptions::target_error`.
struct SolidOptions {
  /// Metres: signed distances are integrated up to this far before and behind the surface. At least
  /// 2.5 voxels, and 3 sigma of the sensor's noise; see `SensorTraits`.
  double truncation = SensorTraits{}.truncation;

  /// With several poses `main` is always used: the object that was turned over is one.
  Parts parts = Parts::main;

  /// Edges are collapsed beyond `target_error` until at most this many triangles are left. Error
  /// "model-too-large" if they cannot be so few.
  std::optional<std::uint64_t> max_triangles = {};
};

/// A plane: points p with normal.p = distance.
struct CutPlane {
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();  ///< of length one, towards what is cut off
  double distance = 0;                                ///< metres

  bool operator==(const CutPlane&) const = default;
};

/// A ball whose inside is removed.
struct ErasedBall {
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();  ///< metres
  double radius = 0;                                 ///< metres

  bool operator==(const ErasedBall&) const = default;
};

/// How a model is laid on another side.
struct LaidSide {
  Eigen::Vector3d down = -Eigen::Vector3d::UnitZ();  ///< of length one; becomes -Z
  Eigen::Vector3d point = Eigen::Vector3d::Zero();   ///< metres; becomes the origin

  bool operator==(const LaidSide&) const = default;
};

/// How a person changed a model. Cuts and balls are in the object's frame. The model is then laid,
/// and scaled about the origin.
struct ModelEdits {
  std::vector<CutPlane> cuts = {};      ///< `solid` only
  std::vector<ErasedBall> erased = {};  ///< `solid` only
  std::optional<LaidSide> lay = {};
  double scale = 1;

  bool operator==(const ModelEdits&) const = default;
  bool change_shape() const { return !cuts.empty() || !erased.empty(); }
  bool move() const { return lay.has_value() || scale != 1; }
};

/// The pose and scale of an edited model.
///
/// The rotation that lays a model is the smallest one; a model is turned over about X.
Eigen::Affine3d model_from_object(const ModelEdits& edits);

/// Options of both methods, except where one is named.
struct ReconstructOptions {
  Method method = Method::intersection;

  /// Metres: maximum side of the leaves (voxels for `solid`), which is the root cube's side halved
  /// as often as needed.
  double leaf_size = SensorTraits{}.leaf_size;

  /// Metres: side of the root cube, which stands on the platform: x, y in [-side/2, side/2], z in
  /// [0, side].
  double root_size = 1.0;

  /// `intersection` only: square metres. A triangle with a squared side above it bridges two
  /// surfaces and is dropped.
  double threshold = 0.0001;

  /// Metres, object's frame. Samples outside are dropped.
  Box clip = {};

  /// Placement of the object in each of several poses, indexed by `Snapshot::pose`; empty for one
  /// pose, in which the object's frame is the platform's. Samples outside the clip box of their own
  /// pose are dropped, too, and so are samples of its platform.
  std::vector<Placement> placements = {};

  /// `intersection` only: the octree level from which the surface is drawn, 0 for the root; the
  /// leaves' level if absent.
  std::optional<int> level = {};

  /// `solid` only: metres. Edges are collapsed while the root mean square distance of the new
  /// vertex from the planes of the triangles that it replaces is at most this; its distance from a
  /// single plane may be larger. 0 keeps all triangles.
  double target_error = SensorTraits{}.target_error;

  SolidOptions solid = {};

  /// `make_reconstructor` applies those that change the shape, and `build_model` all of them.
  ModelEdits edits = {};

  /// At least 1. The model's bytes do not depend on it.
  int threads = 1;

  /// Memory of the whole process, bytes; 0 is no limit. The model's bytes do not depend on it.
  std::size_t memory_limit = 0;

  /// The part of `memory_limit` that the caller's program and its libraries take, bytes.
  std::size_t program_memory = 0;
};

/// The memory that a model needs.
struct MemoryNeed {
  std::size_t bytes = 0;         ///< of the whole process
  double fitting_leaf_size = 0;  ///< metres: the options', doubled until the model fits their limit
};

/// Estimates the memory of the method `solid` from clip box and leaf size, for an object of 10 cm.
/// @throws Error "bad-settings"  that says which option is out of its range
MemoryNeed expected_memory(const ReconstructOptions& options);

/// The thickness of the shells that the method `solid` makes of a space without a platform (see
/// tiles.hpp), metres: two voxels.
double shell_thickness(const ReconstructOptions& options);

/// The size of a surface.
struct SurfaceCount {
  std::uint64_t leaves = 0;  ///< occupied leaves; of the method `solid`, voxels inside
  std::uint64_t facets = 0;
  std::uint64_t parts = 0;           ///< connected components; 0: not counted
  std::uint64_t dropped_parts = 0;   ///< components that are not in the model
  std::uint64_t dropped_leaves = 0;  ///< their voxels
};

class SurfaceCells;

/// Coarse geometry of a model, for `judge`.
struct ModelPlaces {
  /// Metres, object's frame: where the surface above the base was made by hole filling.
  std::vector<Eigen::Vector3d> unseen = {};
  /// The cells of a grid that the surface passes through; null: no surface.
  std::shared_ptr<const SurfaceCells> surface = {};
  /// Metres, object's frame: the middles of leaves all over the model; of `intersection` only.
  std::vector<Eigen::Vector3d> leaves = {};
};

/// Connected components that were seen but left out of a model.
struct DroppedParts {
  std::uint64_t count = 0;
  double volume = 0.0;  ///< cubic metres
};

/// The figures of a finished model.
struct ModelReport {
  std::uint64_t leaves = 0;  ///< occupied leaves; of the method `solid`, voxels inside
  std::uint64_t triangles = 0;
  std::uint64_t bytes = 0;  ///< of the STL
  std::uint64_t parts = 0;  ///< connected components; 0: not counted
  double filled_share = 0;  ///< of the area, made by hole filling, 0 to 1
  double unseen_share = 0;  ///< the same without the base, the facets in z = 0
  ModelPlaces places = {};
  /// Whether the surface is closed. Of the method `solid` every directed edge is compared with its
  /// opposite, corners bit by bit; of `intersection` the sides of neighbouring bricks of leaves,
  /// inside which the surface is closed by construction. An open one is missed with a chance of
  /// 2^-64.
  bool watertight = false;
  double volume = 0.0;  ///< cubic metres; right only if watertight
  DroppedParts dropped = {};
  Eigen::Vector3d size = Eigen::Vector3d::Zero();  ///< metres, of the bounding box
  double bottom = 0.0;                             ///< metres, lowest z of that box
};

/// A reconstruction in progress: snapshots are added, then the surface is drawn. Not thread-safe;
/// each call runs and joins its own threads, as many as the options say.
///
/// Deterministic: the same snapshots in the same order give the same bytes on x86-64 and arm64, for
/// any number of threads and any memory limit.
///
/// Each call checks its stop token in every phase, and throws `Stopped` within a fraction of a
/// second of work after a stop was requested. The reconstruction is then incomplete and must be
/// destroyed.
class Reconstructor {
 public:
  Reconstructor() = default;
  virtual ~Reconstructor() = default;
  Reconstructor(const Reconstructor&) = delete;
  Reconstructor& operator=(const Reconstructor&) = delete;

  /// Adds one snapshot.
  /// @throws Error "memory-limit"   if not even one layer of the observed volume fits
  /// @throws std::invalid_argument  if the frame's size is not that of the intrinsics
  virtual void add(const Snapshot& snapshot, const std::stop_token& stop = {}) = 0;

  /// Adds all snapshots of a source, on as many threads as the options say.
  /// @throws  as above, and whatever the source throws
  virtual void add(const SnapshotSource& snapshots, const std::stop_token& stop = {}) = 0;

  /// Streams the surface of all snapshots.
  ///
  /// @param snapshots  those that were added; read again if the volume exceeds the memory limit and
  ///                   is built slab by slab
  /// @param sink       called by one thread at a time; an exception that it throws ends the call
  /// @throws Error "memory-limit"  if more memory is needed
  virtual SurfaceCount surface(const SnapshotSource& snapshots, const FacetSink& sink,
                               const std::stop_token& stop = {}) = 0;

  /// Streams the surface as `surface` does, and measures it on the way, as `judge` needs it.
  /// @throws  as `surface`
  virtual ModelReport measured_surface(const SnapshotSource& snapshots, const FacetSink& sink,
                                       const std::stop_token& stop = {});

  /// Counts the leaves and facets of `surface`. @throws  as `surface`
  virtual SurfaceCount count(const SnapshotSource& snapshots, const std::stop_token& stop = {}) = 0;

  /// Streams a coarse surface of the snapshots added so far, with leaves of at most `leaf_size`
  /// (metres), or larger ones if there would be more than `max_facets`. If the volume is built slab
  /// by slab, only the slab in memory is shown.
  virtual void preview(double leaf_size, std::uint64_t max_facets, const FacetSink& sink,
                       const std::stop_token& stop = {}) const = 0;
};

/// A reconstruction by the options' method.
///
/// @throws Error "bad-settings"  that says which option is out of its range
/// @throws Error "memory-limit"  that says which limit would be enough
std::unique_ptr<Reconstructor> make_reconstructor(const ReconstructOptions& options);

}  // namespace octurn
