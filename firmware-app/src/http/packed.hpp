#pragma once

#include "http/message.hpp"

namespace octurn {

/// Whether a client accepts gzip: its Accept-Encoding has it with a weight above 0 (RFC 9110,
/// section 12.5.3).
bool takes_gzip(const Request& request);

/// Compresses an answer of JSON, or a whole STL of up to 4 MB, by gzip if the client accepts that;
/// other answers are unchanged. The entity tag becomes a weak one, as it is the same for both
/// encodings.
Response packed(const Request& request, Response response);

}  // namespace octurn
