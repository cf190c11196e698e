#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "http/access_keys.hpp"
#include "http/connections.hpp"
#include "http/message.hpp"
#include "http_options.hpp"

struct mg_connection;

namespace octurn {

/// Serves HTTP on civetweb, with a pool of threads of its own: receives requests within limits of
/// size and time, hands each to `answer`, and sends what it returns. A body of upload_type is for
/// `answer` to read. Ends with its destructor.
class HttpServer {
 public:
  using Answer = std::function<Response(const Request&)>;

  /// Called before authentication; may return an answer, or nothing.
  using Gate = std::function<std::optional<Response>(const Request&)>;

  /// @param answer  called by any thread of the pool; must not throw
  /// @param keys    admit programs as the password admits people; null: there are none
  /// @param gate    as `answer`
  /// @throws Error "listen-failed", "no-descriptors", "bad-password-file"; nothing runs then
  HttpServer(const HttpOptions& options, Answer answer, const AccessKeys* keys = nullptr,
             Gate gate = {});
  ~HttpServer();
  HttpServer(const HttpServer&) = delete;
  HttpServer& operator=(const HttpServer&) = delete;

  int port() const;

 private:
  class Server;
  std::unique_ptr<Server> server_;
};

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
