#pragma once

#include <chrono>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>

#include "http/message.hpp"

namespace octurn {

/// Where the page is served.
struct HttpOptions {
  std::string address = "0.0.0.0";  ///< to listen on; the default is every one of this machine
  int port = 8080;                  ///< 0: any free one
  std::filesystem::path password_file = {};  ///< who may open it; empty: everybody
  std::chrono::milliseconds patience = std::chrono::seconds(10);  ///< with a client that stalls
};

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
