#pragma once

namespace octurn {

/// How a reading at some depth speaks for the samples along its ray. Lengths are in truncations.

/// A sample within one truncation of the reading's tangent plane is integrated unless it lies
/// further than this behind the reading, along the ray: where a ray grazes a surface, the way to
/// it is longer along the ray than across the surface.
inline constexpr float max_behind = 2.5F;

/// Where a pixel has no surface, its ray is free up to this far before the depth that it was free
/// to.
inline constexpr float free_margin = 1.5F;

/// Votes that a ray gives what it passed through. One that ended on the object has its depth; one
/// that ended beyond it, on the platform or in the room, counts half: nothing near vouches for it,
/// and so it takes two of these to open what nobody else saw through.
inline constexpr int votes_of_any_ray = 1;
inline constexpr int votes_of_surface_ray = 2;

/// Behind a surface the weight falls from one at one voxel to zero at the truncation, by this power
/// of the way left, so that one side of a thin wall does not overwrite the other. (A plate of 3 mm
/// came out 15 % too thick by a linear fall, 1.5 % by the cubic one.)
inline constexpr int falloff_power = 3;

}  // namespace octurn
