#pragma once

#include <functional>
#include <memory>

#include "http/message.hpp"
#include "http_options.hpp"

namespace octurn {

/// Serves HTTP on civetweb, with a pool of threads of its own: receives requests within limits of
/// size and time, hands each to `answer`, and sends what it returns. A body of upload_type is for
/// `answer` to read. Ends with its destructor.
class HttpServer {
 public:
  using Answer = std::function<Response(const Request&)>;

  /// @param answer  called by any thread of the pool; must not throw
  /// @throws Error "listen-failed", "bad-password-file"
  HttpServer(const HttpOptions& options, Answer answer);
  ~HttpServer();
  HttpServer(const HttpServer&) = delete;
  HttpServer& operator=(const HttpServer&) = delete;

  int port() const;

 private:
  struct Server;
  std::unique_ptr<Server> server_;
};

}  // namespace octurn
