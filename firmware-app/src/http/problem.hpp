#pragma once

#include "failure.hpp"
#include "http/message.hpp"

namespace octurn {

/// An error as application/problem+json (RFC 9457). The status follows from the code; one that the
/// API does not know is 500.
Response problem(const Failure& failure);

}  // namespace octurn
