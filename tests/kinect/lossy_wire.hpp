#pragma once

#include <array>
#include <ostream>

namespace octurn {

/// A wire on which an emulated Kinect loses packets; without any by default.
struct LossyWire {
  const char* name = "well";
  double random_loss = 0;  ///< share of the packets
  int burst = 0;           ///< packets in a row, about once a second
};

inline std::ostream& operator<<(std::ostream& out, const LossyWire& wire) {
  return out << wire.name;
}

/// Wires on which a scan makes the model of one that is well.
inline constexpr std::array<LossyWire, 6> lossy_wires{{{"1 %", 0.01, 0},
                                                       {"2 %", 0.02, 0},
                                                       {"5 %", 0.05, 0},
                                                       {"bursts of 6", 0, 6},
                                                       {"bursts of 20", 0, 20},
                                                       {"bursts of 100", 0, 100}}};

}  // namespace octurn
