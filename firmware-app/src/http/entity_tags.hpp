#pragma once

#include <string>
#include <string_view>

#include "http/message.hpp"

namespace octurn {

/// The entity tag of a content, in its quotes.
std::string to_entity_tag(std::string_view content);

// Comparison of entity tags (RFC 9110, section 8.8.3.2): `field` is the value of a header that has
// a list of them, or "*", which every tag matches. `tag` is a strong one, in its quotes. What is
// malformed in a list matches nothing, nor does what follows it.

/// As If-Match is compared: a weak tag, W/"...", matches nothing.
bool matches_strongly(std::string_view field, std::string_view tag);

/// As If-None-Match is compared: a weak tag matches a strong one of the same text.
bool matches_weakly(std::string_view field, std::string_view tag);

/// Whether the client says by If-None-Match that it has the content of that tag: 304 is enough.
bool client_has(const Request& request, std::string_view tag);

}  // namespace octurn
