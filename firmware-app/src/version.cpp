#include "version.hpp"

namespace octurn {

std::string_view version() { return OCTURN_VERSION; }

}  // namespace octurn
