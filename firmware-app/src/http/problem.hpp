#pragma once

#include <string_view>

#include "failure.hpp"
#include "http/message.hpp"

namespace octurn {

/// An error that arises only in HTTP and has no ErrorCode.
struct HttpProblem {
  int status = 400;
  std::string_view title = {};
  std::string_view code = {};
  std::string_view detail = {};
  std::string_view hint = {};
  Parameters parameters = {};  ///< the values in `detail`
};

/// An HTTP problem as application/problem+json (RFC 9457).
Response to_response(const HttpProblem& problem);

/// An error as application/problem+json (RFC 9457). The status follows from the code; unknown codes
/// are 500.
Response problem(const Failure& failure);

}  // namespace octurn
