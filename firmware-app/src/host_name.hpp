#pragma once

#include <string>

namespace octurn {

/// What this machine is called in its network.
std::string host_name();

}  // namespace octurn
