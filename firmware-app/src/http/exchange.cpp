#include "http/exchange.hpp"

#include <civetweb.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <stop_token>
#include <utility>
#include <vector>

#include "log.hpp"
#include "octurn/error.hpp"

namespace octurn {
namespace {

// Bodies other than uploads are small: settings, or a name.
constexpr std::size_t max_body = std::size_t{64} * 1024;    // bytes
constexpr std::size_t file_part = std::size_t{64} * 1024;   // bytes read from a file at a time
constexpr std::size_t write_part = std::size_t{16} * 1024;  // bytes: progress counts after each

/// Headers of every answer. The page loads nothing from other sites, no other site may embed or
/// read it, and browsers must not sniff content types.
const Headers common_headers{
    {"Content-Security-Policy",
     "default-src 'self'; img-src 'self' blob: data:; object-src 'none'; base-uri 'none'; "
     "form-action 'none'; frame-ancestors 'none'"},
    {"X-Content-Type-Options", "nosniff"},
    {"Referrer-Policy", "no-referrer"},
    {"Cross-Origin-Resource-Policy", "same-origin"},
};
const Headers closing_headers{{"Connection", "close"}};
const Headers keeping_headers{{"Connection", "keep-alive"},
                              {"Keep-Alive", "timeout=" + std::to_string(idle_seconds)}};

/// The length of a body in bytes; nothing if it is not known in advance.
std::optional<std::uint64_t> body_length(const Response& response) {
  if (const auto* slice = std::get_if<FileSlice>(&response.body)) {
    return slice->length;
  }
  if (const auto* stream = std::get_if<ByteStream>(&response.body)) {
    return stream->length;
  }
  return std::get<std::string>(response.body).size();
}

/// Whether a client asks for a persistent connection, as browsers do. After a request with a body
/// the connection closes, as part of the body may be unread.
bool asks_to_keep(const mg_request_info& info) {
  const std::string_view method = info.request_method;
  const auto headers =
      std::span(info.http_headers).first(static_cast<std::size_t>(info.num_headers));
  // civetweb takes a length that is no number for 0, and the first of two: see expect_clear_length.
  const bool has_body = std::ranges::any_of(headers, [](const mg_header& header) {
    return same_token(header.name, "Transfer-Encoding") ||
           (same_token(header.name, "Content-Length") && std::string_view(header.value) != "0");
  });
  return (method == "GET" || method == "HEAD") && !has_body &&
         std::string_view(info.http_version) == "1.1" &&
         std::ranges::any_of(headers, [](const mg_header& header) {
           return same_token(header.name, "Connection") && same_token(header.value, "keep-alive");
         });
}

std::string to_head(const Response& response, bool keeps) {
  const char* const reason = mg_get_response_code_text(nullptr, response.status);
  std::string head = "HTTP/1.1 " + std::to_string(response.status) + " " + reason + "\r\n";
  const auto append = [&](const Headers& headers) {
    for (const auto& [name, value] : headers) {
      head.append(name).append(": ").append(value).append("\r\n");
    }
  };
  append(response.headers);
  append(common_headers);
  append(keeps ? keeping_headers : closing_headers);
  const auto length = body_length(response);
  if (length && response.status != 204 && response.status != 304) {
    head += "Content-Length: " + std::to_string(*length) + "\r\n";
  }
  return head + "\r\n";
}

/// The authority of a request target: "scanner:8080" of "http://scanner:8080/path". Nothing for a
/// target that is a path.
std::optional<std::string_view> authority(std::string_view target) {
  constexpr std::string_view separator = "://";
  const std::size_t scheme = target.find(separator);
  if (target.starts_with('/') || scheme == std::string_view::npos) {
    return std::nullopt;
  }
  target.remove_prefix(scheme + separator.size());
  return target.substr(0, target.find_first_of("/?#"));
}

/// The names and values of a query, decoded.
Headers to_parameters(const char* query) {
  std::string text(query != nullptr ? query : "");
  std::array<mg_header, 16> fields{};  // more than any handler accepts
  const int count = mg_split_form_urlencoded(text.data(), fields.data(), fields.size());
  Headers parameters;
  for (const mg_header& field : std::span(fields).first(static_cast<std::size_t>(count))) {
    parameters.emplace_back(field.name, field.value != nullptr ? field.value : "");
  }
  return parameters;
}

}  // namespace

Exchange::Exchange(mg_connection& connection, ConnectionGuard& guard)
    : connection_(connection), guard_(guard) {
  if (const mg_request_info* const info = mg_get_request_info(&connection)) {
    key_ = guard.claim(info->remote_addr, info->remote_port);
  }
}

Request Exchange::head() {
  const mg_request_info& info = *mg_get_request_info(&connection_);
  may_keep_ = asks_to_keep(info);
  Request request{.method = info.request_method,
                  .path = info.local_uri != nullptr ? info.local_uri : "",
                  .parameters = to_parameters(info.query_string)};
  if (const auto host = authority(info.request_uri != nullptr ? info.request_uri : "")) {
    request.headers.emplace_back("Host", *host);  // the first of a name is in force
  }
  for (int i = 0; i < info.num_headers; ++i) {
    const mg_header& header = info.http_headers[i];
    request.headers.emplace_back(header.name, header.value);
  }
  return request;
}

void Exchange::expect_clear_length() const {
  const mg_request_info& info = *mg_get_request_info(&connection_);
  const auto headers =
      std::span(info.http_headers).first(static_cast<std::size_t>(info.num_headers));
  int lengths = 0;
  for (const mg_header& header : headers) {
    if (same_token(header.name, "Content-Length")) {
      const std::string_view value = header.value;
      ++lengths;
      if (lengths > 1 || value.find_first_not_of("0123456789") != std::string_view::npos) {
        throw Error(ErrorCode::bad_request, "the length of the body is in doubt",
                    "Send one header Content-Length, a number.");
      }
    }
  }
}

/// @return bytes; 0 at the end; negative if the body is malformed
int Exchange::read(std::span<char> buffer, Wait wait) {
  ConnectionGuard::Waiting waiting(guard_, key_, wait);
  const int got = mg_read(&connection_, buffer.data(), buffer.size());
  waiting.add_bytes(static_cast<std::uint64_t>(std::max(got, 0)));
  return got;
}

std::string Exchange::read_body() {
  const long long announced = mg_get_request_info(&connection_)->content_length;
  const auto expect_small = [](std::uint64_t bytes) {
    if (bytes > max_body) {
      throw Error(ErrorCode::too_large, "a body is at most " + std::to_string(max_body) + " bytes",
                  "Send the settings only.");
    }
  };
  expect_small(static_cast<std::uint64_t>(std::max(announced, 0LL)));
  std::string body;
  std::array<char, 4096> part{};
  int got = 1;
  while (got > 0) {
    got = read(part, Wait::body);
    body.append(part.data(), static_cast<std::size_t>(std::max(got, 0)));
    expect_small(body.size());
  }
  if (guard_.is_cut(key_)) {
    throw Error(ErrorCode::too_slow,
                std::to_string(body.size()) + " bytes of the body came in time",
                "Send the request again.");
  }
  if (got < 0) {
    throw Error(ErrorCode::bad_request, "the body is cut off, or malformed",
                "Send the request again.");
  }
  if (announced >= 0 && body.size() != static_cast<std::size_t>(announced)) {
    throw Error(ErrorCode::cut_short,
                std::to_string(body.size()) + " of " + std::to_string(announced) + " bytes came",
                "Send the request again.");
  }
  return body;
}

ByteSource Exchange::upload() {
  const long long announced = mg_get_request_info(&connection_)->content_length;
  std::optional<std::uint64_t> length;
  if (announced >= 0) {
    length = static_cast<std::uint64_t>(announced);
  }
  return {
      .length = length, .read = [this](std::span<std::byte> buffer) {
        const int got = read({reinterpret_cast<char*>(buffer.data()), buffer.size()}, Wait::upload);
        return static_cast<std::size_t>(std::max(got, 0));
      }};
}

/// @return false if the connection has ended
bool Exchange::write(std::string_view bytes) {
  ConnectionGuard::Waiting waiting(guard_, key_, Wait::reader);
  while (!bytes.empty()) {
    const std::string_view part = bytes.substr(0, write_part);
    if (mg_write(&connection_, part.data(), part.size()) != static_cast<int>(part.size())) {
      return false;
    }
    waiting.add_bytes(part.size());
    bytes.remove_prefix(part.size());
  }
  return true;
}

/// @return false if the client has not received all bytes
bool Exchange::send_slice(const FileSlice& slice) {
  std::vector<char> buffer(file_part);
  std::uint64_t sent = 0;
  while (sent < slice.length) {
    const std::size_t wanted = std::min<std::uint64_t>(buffer.size(), slice.length - sent);
    const ssize_t got = ::pread(slice.file.number(), buffer.data(), wanted,
                                static_cast<off_t>(slice.offset + sent));
    if (got <= 0) {
      log::error("http", "a model could not be read to its end");
      return false;  // the connection closes short of Content-Length, which tells the client
    }
    if (!write({buffer.data(), static_cast<std::size_t>(got)})) {
      return false;
    }
    sent += static_cast<std::uint64_t>(got);
  }
  return true;
}

void Exchange::send_stream(ByteStream& stream) {
  const std::stop_callback at_stop(stream.stop, [this] { guard_.reset(key_); });
  stream.make([&](std::span<const std::byte> bytes) {
    return write({reinterpret_cast<const char*>(bytes.data()), bytes.size()});
  });
}

void Exchange::send(std::string_view method, Response response) {
  guard_.restart(key_, Wait::server);
  const auto* text = std::get_if<std::string>(&response.body);
  const auto* slice = std::get_if<FileSlice>(&response.body);
  auto* const stream = std::get_if<ByteStream>(&response.body);
  const std::string head = to_head(response, may_keep_ && stream == nullptr);
  bool is_whole = false;
  if (method == "HEAD") {
    is_whole = write(head);
  } else if (text != nullptr) {
    is_whole = write(head + *text);
  } else if (!write(head)) {
    is_whole = false;
  } else if (slice != nullptr) {
    is_whole = send_slice(*slice);
  } else {
    send_stream(*stream);  // it may end early, which only closing shows to the client
  }
  if (may_keep_ && stream == nullptr && is_whole) {
    guard_.restart(key_, Wait::head);
    return;
  }
  mg_disable_connection_keep_alive(&connection_);
  guard_.restart(key_, Wait::close);
}

}  // namespace octurn
