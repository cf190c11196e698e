#include "octurn/solid.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "fork_join.hpp"
#include "in_order.hpp"
#include "octurn/error.hpp"
#include "octurn/filled_field.hpp"
#include "octurn/fuse.hpp"
#include "octurn/marching_cubes.hpp"
#include "octurn/sighting.hpp"
#include "octurn/simplify.hpp"
#include "octurn/units.hpp"

namespace octurn {
namespace {

// Distances are kept this far from a surface: three times a Kinect's noise at 0.65 m, but no less
// than the leaves need.
constexpr double truncation = 0.0035;  // metres
constexpr double least_truncation_leaves = 2.5;

// The lowest layers of the clip box are partly the platform's noise: the first that counts is this
// far above its bottom.
constexpr double foot_margin = 0.001;  // metres

// What a process takes beside its field, measured with a sensor's 640 x 480 samples: the program
// and its libraries, for each thread a snapshot and what it says, and the mesh on its way out.
constexpr std::size_t program_bytes = std::size_t{10} << 20U;
constexpr std::size_t thread_bytes = std::size_t{14} << 20U;
constexpr std::size_t surface_bytes = std::size_t{16} << 20U;
constexpr std::size_t least_field_bytes = std::size_t{4} << 20U;

/// How far below the upper end of its window a mesh is simplified, in leaves.
constexpr double margin_leaves = 8;

std::string mb_text(std::size_t bytes) {
  return std::to_string((bytes + (std::size_t{1} << 20U) - 1) >> 20U) + " MB";
}

std::size_t beside_field(const ReconstructOptions& options) {
  return program_bytes +
         std::max(static_cast<std::size_t>(options.threads) * thread_bytes, surface_bytes);
}

/// @returns the options, with as many threads as asked for, or as the memory limit leaves room for
ReconstructOptions checked(ReconstructOptions options) {
  checked_levels(options);
  if (options.level) {
    throw Error("bad-settings", "level: the method solid has none");
  }
  if (!std::isfinite(options.max_error) || options.max_error < 0) {
    throw Error("bad-settings", "max error: must be 0 or above");
  }
  if (options.memory_limit != 0) {
    while (options.threads > 1 &&
           beside_field(options) + least_field_bytes > options.memory_limit) {
      --options.threads;
    }
    if (const std::size_t least = beside_field(options) + least_field_bytes;
        least > options.memory_limit) {
      throw Error("memory-limit",
                  "memory limit: " + mb_text(options.memory_limit) + " is too little",
                  "Allow at least " + mb_text(least) + ".");
    }
  }
  return options;
}

DistanceField field_for(const ReconstructOptions& options) {
  const int levels = checked_levels(options);
  const double leaf_side = options.root_size / (1 << levels);
  DistanceField field(options.root_size, levels, options.clip,
                      std::max(truncation, least_truncation_leaves * leaf_side),
                      options.memory_limit == 0 ? std::numeric_limits<std::size_t>::max()
                                                : options.memory_limit - beside_field(options));
  return field;
}

/// Facets of a mesh as it comes, with all its triangles.
class Facets {
 public:
  explicit Facets(const FacetSink& sink) : sink_(sink) {}

  void add(const MeshPiece& piece) {
    // Triangles have no vertices but those of this piece and of the one before.
    vertices_.erase(vertices_.begin(), vertices_.end() - static_cast<std::ptrdiff_t>(last_));
    first_ = next_ - static_cast<std::uint32_t>(last_);
    last_ = piece.vertices.size();
    next_ += static_cast<std::uint32_t>(last_);
    vertices_.insert(vertices_.end(), piece.vertices.begin(), piece.vertices.end());
    facets_.clear();
    for (const MeshTriangle& triangle : piece.triangles) {
      facets_.push_back(facet_of({vertices_[triangle[0] - first_], vertices_[triangle[1] - first_],
                                  vertices_[triangle[2] - first_]}));
    }
    sink_(facets_);
  }

 private:
  const FacetSink& sink_;
  std::vector<MeshVertex> vertices_ = {};
  std::vector<Facet> facets_ = {};
  std::size_t last_ = 0;  // vertices of the last piece
  std::uint32_t first_ = 0;
  std::uint32_t next_ = 0;
};

}  // namespace

Solid::Solid(const ReconstructOptions& options)
    : options_(checked(options)), field_(field_for(options_)) {}

void Solid::add(const Snapshot& snapshot) {
  add({.count = 1, .read = [&](std::size_t) { return snapshot; }});
}

void Solid::add(const SnapshotSource& snapshots, const std::stop_token& stop) try {
  const int threads = std::clamp(static_cast<int>(snapshots.count), 1, options_.threads);
  auto next = [&, shot = std::size_t{0}]() mutable -> std::optional<std::size_t> {
    return shot < snapshots.count && !stop.stop_requested() ? std::optional(shot++) : std::nullopt;
  };
  InOrder<decltype(next), std::optional<Sighting>> shots(next, threads);
  fork_join(threads, [&](int) {
    shots.take_all(
        [&](std::size_t shot, std::optional<Sighting>& sighting) {
          sighting.emplace(snapshots.read(shot), options_.clip);
        },
        [&](std::optional<Sighting>& sighting) {
          fuse(field_, *sighting);
          sighting.reset();
        });
  });
} catch (const OctreeFull&) {
  throw Error("memory-limit",
              "memory limit: " + mb_text(options_.memory_limit) + " do not hold what was seen",
              "Allow " + mb_text(2 * options_.memory_limit) + ", or choose a larger leaf size.");
}

/// The lowest layer of leaves that counts.
int Solid::foot() const {
  const double bottom = std::max(options_.clip.min.z(), 0.0);
  return static_cast<int>(std::ceil((bottom + foot_margin) / field_.leaf_side() - 0.5));
}

SurfaceCount Solid::surface(const SnapshotSource& /*snapshots*/, const FacetSink& sink) const {
  const FilledField filled(field_, foot());
  LeafSet part = filled.inside();
  part.keep_part();
  part.fill_cavities();
  SurfaceCount count{.leaves = part.count(), .facets = 0, .parts = part.count_parts()};
  const FacetSink counted = [&](std::span<const Facet> facets) {
    count.facets += facets.size();
    sink(facets);
  };
  if (options_.max_error > 0) {
    Simplifier simplifier(mm_from_metres(options_.max_error),
                          mm_from_metres(margin_leaves * field_.leaf_side()), counted);
    marching_cubes(part, filled, [&](const MeshPiece& piece) { simplifier.add(piece); });
    simplifier.finish();
  } else {
    Facets facets(counted);
    marching_cubes(part, filled, [&](const MeshPiece& piece) { facets.add(piece); });
  }
  return count;
}

SurfaceCount Solid::count(const SnapshotSource& snapshots) const {
  return surface(snapshots, [](std::span<const Facet>) {});
}

void Solid::preview(double leaf_size, std::uint64_t most_facets, const FacetSink& sink) const {
  const int level = std::min(Octree::level_of(field_.side(), leaf_size), field_.levels());
  const int finer = field_.levels() - level;
  const FilledField filled(field_, foot());
  LeafSet part = filled.inside();
  part.keep_part();
  Octree coarse(field_.side(), level);
  for (int z = 0; z < part.size().z; ++z) {
    for (int y = 0; y < part.size().y; ++y) {
      const auto row = part.row(y, z);
      for (std::size_t word = 0; word < row.size(); ++word) {
        for (std::uint64_t rest = row[word]; rest != 0; rest &= rest - 1) {
          const int x = static_cast<int>(word) * 64 + std::countr_zero(rest);
          coarse.set({(part.low().x + x) >> finer, (part.low().y + y) >> finer,
                      (part.low().z + z) >> finer});
        }
      }
    }
  }
  coarse_isosurface(std::move(coarse), most_facets, sink);
}

}  // namespace octurn
