#pragma once

#include <cstddef>

#include "octurn/reconstruct.hpp"
#include "tsdf/compact_tsdf.hpp"
#include "tsdf/hole_filled_sdf.hpp"

namespace octurn {

/// How the method `solid` shares out the memory limit of its options.

/// @return the options, with no more threads than the memory limit leaves room for
/// @throws Error "bad-settings", "memory-limit"
ReconstructOptions checked_solid_options(ReconstructOptions options);

/// Maximum bytes of the volume and the compact TSDF together.
/// @param options  checked
std::size_t volume_budget(const ReconstructOptions& options);

/// Maximum bytes of a slab of the volume, so that its compact form fits beside it.
/// @param known  the slabs that are finished
std::size_t slab_budget(const ReconstructOptions& options, const CompactTsdf& known);

/// Bytes of the mask of an SDF's box, plus half as much to find its components.
std::size_t mask_bytes(const HoleFilledSdf& sdf);

/// @throws Error "memory-limit"  if so many bytes beside the program exceed the limit
void expect_room(const ReconstructOptions& options, std::size_t bytes);

/// Maximum bytes of the facets of a counted surface, kept so that they need not be made again.
/// @param taken  bytes of this surface, besides the fixed memory of any surface
std::size_t facets_budget(const ReconstructOptions& options, std::size_t taken);

/// @throws Error "memory-limit"
[[noreturn]] void throw_memory_limit(const ReconstructOptions& options);

}  // namespace octurn
