#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>

#include "http/connection_guard.hpp"
#include "http/message.hpp"

struct mg_connection;

namespace octurn {

/// How long a connection is kept for a next request.
inline constexpr int idle_seconds = 5;

/// One request and its answer over a connection of civetweb, within the limits of the guard.
class Exchange {
 public:
  /// @param connection  with a parsed head; one with a malformed head can only be answered
  Exchange(mg_connection& connection, ConnectionGuard& guard);

  /// The request without its body. The host of an absolute request target is in force over the
  /// Host header (RFC 9112, section 3.2.2).
  Request head();

  /// @throws Error "bad-request"  if a proxy before the server may take another length of the body:
  ///                              it is no number, or said twice
  void expect_clear_length() const;

  /// The whole body.
  /// @throws Error "too-large", "too-slow"; "cut-short", "bad-request" if it is not what was
  /// announced
  std::string read_body();

  /// The body, to be read in parts. Unread bytes are discarded.
  ByteSource upload();

  /// Sends an answer, or as much of it as the client receives.
  /// @param method  of the request
  void send(std::string_view method, Response response);

 private:
  int read(std::span<char> buffer, Wait wait);
  bool write(std::string_view bytes);
  bool send_slice(const FileSlice& slice);
  void send_stream(ByteStream& stream);

  mg_connection& connection_;
  ConnectionGuard& guard_;
  ConnectionGuard::Key key_ = ConnectionGuard::unknown;
  bool may_keep_ = false;  // the client asks for a persistent connection
};

}  // namespace octurn
