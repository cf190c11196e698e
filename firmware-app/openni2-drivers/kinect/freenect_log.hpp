#pragma once

#include <libfreenect.h>

namespace octurn {

/// Silences libfreenect, which writes its log to standard error. The driver reports faults as
/// errors.
inline void discard_log(freenect_context* /*context*/, freenect_loglevel /*level*/,
                        const char* /*text*/) {}

}  // namespace octurn
