#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <future>
#include <optional>
#include <span>
#include <stop_token>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "file_descriptor.hpp"

namespace octurn {

inline constexpr std::string_view upload_type = "application/octet-stream";

/// Names and values, in order.
using Headers = std::vector<std::pair<std::string, std::string>>;

/// Whether two header names or tokens are equal, ignoring ASCII case.
inline bool same_token(std::string_view a, std::string_view b) {
  const auto lower = [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c; };
  return std::ranges::equal(a, b, {}, lower, lower);
}

/// Whether a Content-Type is this one, ignoring parameters.
inline bool is_of_type(std::string_view content_type, std::string_view type) {
  content_type = content_type.substr(0, content_type.find(';'));
  while (content_type.ends_with(' ')) {
    content_type.remove_suffix(1);
  }
  return same_token(content_type, type);
}

inline constexpr std::string_view zip_type = "application/zip";
inline constexpr std::string_view import_path = "/api/v1/scans/import";

/// A body that is too large for memory and is read in parts.
struct ByteSource {
  std::optional<std::uint64_t> length = {};  ///< as announced
  /// Fills a buffer from its start. @return bytes read; 0 at the end of the body
  std::function<std::size_t(std::span<std::byte>)> read = {};
};

/// A request. Its body is complete, or, of an upload, still to be read.
struct Request {
  std::string method = "GET";
  std::string path = "/";   ///< decoded, without the query
  Headers parameters = {};  ///< of the query, decoded, in order
  Headers headers = {};
  std::string body = {};
  ByteSource upload = {};

  /// The value of the first header of that name.
  std::optional<std::string_view> header(std::string_view name) const {
    const auto found = std::ranges::find_if(
        headers, [&](const auto& header) { return same_token(header.first, name); });
    return found == headers.end() ? std::nullopt : std::optional<std::string_view>(found->second);
  }

  bool is_read() const { return method == "GET" || method == "HEAD"; }
};

/// Whether the body of a request is read in parts, as uploads are. A scan's archive may also come
/// with its own type, or with none.
inline bool is_upload(const Request& request) {
  const std::string_view type = request.header("Content-Type").value_or("");
  return is_of_type(type, upload_type) ||
         (request.path == import_path && (type.empty() || is_of_type(type, zip_type)));
}

/// A part of an open file, sent as it is read.
struct FileSlice {
  FileDescriptor file = {};
  std::uint64_t offset = 0;
  std::uint64_t length = 0;
};

/// Receives bytes. @return false if no more are wanted
using ByteSink = std::function<bool(std::span<const std::byte>)>;

/// A body that is made while it is sent.
struct ByteStream {
  std::optional<std::uint64_t> length = {};  ///< nothing: it ends with the connection
  std::stop_token stop = {};  ///< ends the answer at once, even if its reader is slow
  /// Passes the whole body to the sink, in order, until it returns false. Does not throw. Called
  /// once; a packaged_task, since a std::function must be copyable.
  std::packaged_task<void(const ByteSink&)> make = {};
};

/// An answer. The server adds Content-Length and the headers of every answer, and omits the body if
/// the request was HEAD.
struct Response {
  int status = 200;
  Headers headers = {};
  std::variant<std::string, FileSlice, ByteStream> body = {};
};

}  // namespace octurn
