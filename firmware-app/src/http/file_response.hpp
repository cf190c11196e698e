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

}  // namespace octurn
