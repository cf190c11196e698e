#pragma once

#include "http/message.hpp"

namespace octurn {

/// Whether a client takes gzip: its Accept-Encoding has it, not with the weight 0 (RFC 9110,
/// section 12.5.3).
bool takes_gzip(const Request& request);

/// An answer of JSON packed by gzip where the client takes that and it is worth it; any other as it
/// is. Its entity tag becomes a weak one, as it is that of the JSON, packed or not.
Response packed(const Request& request, Response response);

}  // namespace octurn
