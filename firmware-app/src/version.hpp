#pragma once

#include <string_view>

namespace octurn {

/// This program's version, as CMakeLists.txt sets it.
std::string_view version();

}  // namespace octurn
