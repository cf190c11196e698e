#pragma once

#include <string>

namespace octurn {

/// Returns this machine's host name (gethostname(2)).
std::string host_name();

}  // namespace octurn
