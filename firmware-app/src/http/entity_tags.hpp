#pragma once

#include <string>
#include <string_view>

#include "http/message.hpp"

namespace octurn {

/// The strong entity tag of a content, with its quotes.
std::string to_entity_tag(std::string_view content);

// Comparison of entity tags (RFC 9110, section 8.8.3.2). `field` is a header's value: a list of
// tags, or "*", which every tag matches. `tag` is a strong one, with its quotes. A malformed tag in
// a list, and all tags after it, match nothing.

/// The strong comparison, of If-Match: a weak tag, W/"...", matches nothing.
bool matches_strongly(std::string_view field, std::string_view tag);

/// The weak comparison, of If-None-Match: a weak tag matches a strong one of the same text.
bool matches_weakly(std::string_view field, std::string_view tag);

/// Whether the client's If-None-Match matches that tag, so that the answer is 304.
bool client_has(const Request& request, std::string_view tag);

}  // namespace octurn
