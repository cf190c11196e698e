#pragma once

#include <Eigen/Geometry>
#include <functional>

#include "simulator/mesh.hpp"

namespace octurn {

/// The object that stands on the simulated platform if no mesh is given: a robot, 16 cm tall, that
/// waves a flag. It shows what a scanner can and cannot do: round limbs, flat feet and sides, a
/// hollow in the belly and two for eyes, a flag of 2.4 mm and its pole of 3 mm, and overhangs under
/// chin, arms and body.
///
/// @param point  platform frame at angle 0 (the robot looks along -Y, to the sensor), metres
/// @return 0 on the surface, negative inside. Elsewhere its magnitude is a lower bound of the
///         distance to the surface, so a ray may always advance by it.
double simulator_object_distance(const Eigen::Vector3d& point);

/// A box that holds the whole object, metres.
Eigen::AlignedBox3d simulator_object_bounds();

/// The object as a closed mesh, of cells of 1.25 mm, about a pixel.
Mesh simulator_object();

/// A signed distance, metres, negative inside. Its magnitude is at most the distance to the
/// surface.
using SignedDistance = std::function<double(const Eigen::Vector3d&)>;

/// Meshes the surface where a signed distance is 0, by surface nets (Gibson 1998, "Constrained
/// elastic surface nets"): one vertex in each cell that the surface crosses, moved onto the
/// surface, and one quadrilateral around each crossed edge. Between vertices the mesh leaves the
/// surface by less than cell^2 / (4 r), r its radius of curvature.
///
/// @param bounds  holds the whole surface, metres
/// @param cell    side of a cell, metres
/// Deterministic. Cost grows with the surface, not with the box: cells far from it are skipped.
Mesh surface_net(const SignedDistance& distance, const Eigen::AlignedBox3d& bounds, double cell);

}  // namespace octurn
