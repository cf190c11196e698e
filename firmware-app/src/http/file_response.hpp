#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "http/message.hpp"

namespace octurn {

/// Answers a GET or HEAD of a file with the headers and conditions of RFC 9110, sections 13 and 14:
/// ETag, If-Match, If-None-Match, If-Range and Range. A request for several ranges gets the whole
/// file; one for a range outside the file gets 416.
///
/// @param name  under which a browser saves it
/// @throws Error "no-model" if there is no such file, "changed" if If-Match fails
Response file_response(const Request& request, const std::filesystem::path& file,
                       const std::string& content_type, const std::string& name);

/// The value of a Content-Disposition that has a browser save a file under that name (RFC 6266).
std::string attachment(std::string_view name);

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

/// Whether a client accepts gzip: its Accept-Encoding has it with a weight above 0 (RFC 9110,
/// section 12.5.3).
bool takes_gzip(const Request& request);

/// Compresses an answer of JSON, or a whole STL of up to 4 MB, by gzip if the client accepts that;
/// other answers are unchanged. The entity tag becomes a weak one, as it is the same for both
/// encodings.
Response packed(const Request& request, Response response);

}  // namespace octurn
