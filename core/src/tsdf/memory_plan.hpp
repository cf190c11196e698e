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

/// Bytes that the volume and the compact TSDF may take together.
/// @param options  checked
std::size_t volume_budget(const ReconstructOptions& options);

/// Bytes that a slab of the volume may take, so that its compact form fits beside it.
/// @param known  the slabs that are finished
std::size_t slab_budget(const ReconstructOptions& options, const CompactTsdf& known);

/// Bytes of the mask of an SDF's box, and half as much to find its components.
std::size_t mask_bytes(const HoleFilledSdf& sdf);

/// Expects room for so many bytes beside the program. @throws Error "memory-limit"
void expect_room(const ReconstructOptions& options, std::size_t bytes);

/// Bytes that the facets of a finished surface may take, so that they need not be made again.
/// @param taken  while the surface is made, beside what it always takes
std::size_t facets_budget(const ReconstructOptions& options, std::size_t taken);

/// @throws Error "memory-limit"
[[noreturn]] void throw_memory_limit(const ReconstructOptions& options);

}  // namespace octurn
