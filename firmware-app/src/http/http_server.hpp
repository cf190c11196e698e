#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "http/access_keys.hpp"
#include "http/connections.hpp"
#include "http/message.hpp"
#include "http_options.hpp"

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

}  // namespace octurn
