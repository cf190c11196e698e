#pragma once

#include <Eigen/Geometry>

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

}  // namespace octurn
