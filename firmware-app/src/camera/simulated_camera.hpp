#pragma once

#include "camera/lasers.hpp"
#include "rig/laser_simulation.hpp"

namespace octurn {

/// Loads the simulator and makes a camera with lasers. It takes 15 pictures a second, as far as the
/// processor keeps up: each as it is read, so that it shows platform and lasers as they are then.
/// @param speed  times faster than life
/// @param late   how many pictures ago a picture was exposed, as its stamp does not say
/// @throws Error "mesh-malformed"; "internal" if the simulator cannot be loaded
CameraAndLasers simulate_laser_rig(const LaserSimulation& simulation, double speed, int late = 0);

}  // namespace octurn
