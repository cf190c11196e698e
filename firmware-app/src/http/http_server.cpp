#include "http/http_server.hpp"

#include <civetweb.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <future>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "http/password_file.hpp"
#include "http/problem.hpp"
#include "log.hpp"
#include "octurn/error.hpp"

namespace octurn {
namespace {

using Clock = std::chrono::steady_clock;

// A request is small: settings, a name. What is larger, or slower, is not meant for us.
constexpr std::size_t most_body = std::size_t{64} * 1024;  // bytes
constexpr std::size_t chunk = std::size_t{64} * 1024;      // bytes read from a file at a time

/// civetweb spends a thread on each open connection; a browser opens up to six. A chunk that is not
/// taken, or a head that has not come, within request_timeout_ms ends the connection.
constexpr std::array<std::pair<const char*, const char*>, 8> fixed_options{{
    {"num_threads", "16"},
    {"max_request_size", "16384"},  // of the head, bytes
    {"enable_keep_alive", "no"},
    {"linger_timeout_ms", "1000"},
    {"tcp_nodelay", "1"},
    {"enable_directory_listing", "no"},
    {"access_control_allow_origin", ""},
    {"access_control_allow_methods", ""},
}};

/// What every answer has. The page loads nothing from elsewhere, and no other page may show it,
/// read it, or guess what its files are.
const Headers common_headers{
    {"Content-Security-Policy",
     "default-src 'self'; img-src 'self' blob: data:; object-src 'none'; base-uri 'none'; "
     "form-action 'none'; frame-ancestors 'none'"},
    {"X-Content-Type-Options", "nosniff"},
    {"Referrer-Policy", "no-referrer"},
    {"Cross-Origin-Resource-Policy", "same-origin"},
    {"Connection", "close"},
};

std::uint64_t length_of(const Response& response) {
  if (const auto* slice = std::get_if<FileSlice>(&response.body)) {
    return slice->length;
  }
  if (const auto* stream = std::get_if<ByteStream>(&response.body)) {
    return stream->length;
  }
  return std::get<std::string>(response.body).size();
}

std::string head_of(const Response& response) {
  const char* const reason = mg_get_response_code_text(nullptr, response.status);
  std::string head = "HTTP/1.1 " + std::to_string(response.status) + " " + reason + "\r\n";
  const auto append = [&](const Headers& headers) {
    for (const auto& [name, value] : headers) {
      head.append(name).append(": ").append(value).append("\r\n");
    }
  };
  append(response.headers);
  append(common_headers);
  if (response.status != 204 && response.status != 304) {
    head += "Content-Length: " + std::to_string(length_of(response)) + "\r\n";
  }
  return head + "\r\n";
}

/// @return false if the connection has ended
bool write(mg_connection* connection, std::string_view bytes) {
  return mg_write(connection, bytes.data(), bytes.size()) == static_cast<int>(bytes.size());
}

void send_slice(mg_connection* connection, const FileSlice& slice) {
  std::vector<char> buffer(chunk);
  std::uint64_t sent = 0;
  while (sent < slice.length) {
    const std::size_t wanted = std::min<std::uint64_t>(buffer.size(), slice.length - sent);
    const ssize_t got = ::pread(slice.file.number(), buffer.data(), wanted,
                                static_cast<off_t>(slice.offset + sent));
    if (got <= 0) {
      log::error("http", "a model could not be read to its end");
      return;  // the connection closes short of Content-Length, which tells the client
    }
    if (!write(connection, {buffer.data(), static_cast<std::size_t>(got)})) {
      return;
    }
    sent += static_cast<std::uint64_t>(got);
  }
}

void send_stream(mg_connection* connection, ByteStream& stream) {
  stream.make([&](std::span<const std::byte> bytes) {
    bool sent = true;
    for (; sent && !bytes.empty(); bytes = bytes.subspan(std::min(chunk, bytes.size()))) {
      const std::size_t size = std::min(chunk, bytes.size());
      sent = write(connection, {reinterpret_cast<const char*>(bytes.data()), size});
    }
    return sent;
  });
}

void send(mg_connection* connection, std::string_view method, Response response) {
  const std::string head = head_of(response);
  const auto* text = std::get_if<std::string>(&response.body);
  const auto* slice = std::get_if<FileSlice>(&response.body);
  if (method == "HEAD") {
    write(connection, head);
  } else if (text != nullptr) {
    write(connection, head + *text);
  } else if (!write(connection, head)) {
    return;
  } else if (slice != nullptr) {
    send_slice(connection, *slice);
  } else {
    send_stream(connection, std::get<ByteStream>(response.body));
  }
}

Request head_from(const mg_request_info& info) {
  Request request{.method = info.request_method,
                  .path = info.local_uri ? info.local_uri : "",
                  .query = info.query_string ? info.query_string : ""};
  for (int i = 0; i < info.num_headers; ++i) {
    const mg_header& header = info.http_headers[i];
    request.headers.emplace_back(header.name, header.value);
  }
  return request;
}

/// @return the body, or nothing if it is too large or too slow
std::optional<std::string> read_body(mg_connection* connection, long long announced,
                                     std::chrono::milliseconds patience) {
  if (announced > static_cast<long long>(most_body)) {
    return std::nullopt;
  }
  const Clock::time_point deadline = Clock::now() + patience;
  std::string body;
  std::array<char, 4096> part{};
  for (int got = 1; got > 0;) {
    got = mg_read(connection, part.data(), part.size());
    body.append(part.data(), static_cast<std::size_t>(got > 0 ? got : 0));
    if (body.size() > most_body || Clock::now() > deadline) {
      return std::nullopt;
    }
  }
  return body;
}

/// The body of a request, to be read as it comes. What is not read of it, civetweb drops.
ByteSource upload_from(mg_connection* connection, long long announced) {
  std::optional<std::uint64_t> length;
  if (announced >= 0) {
    length = static_cast<std::uint64_t>(announced);
  }
  return {.length = length, .read = [connection](std::span<std::byte> buffer) {
            const int got = mg_read(connection, buffer.data(), buffer.size());
            return static_cast<std::size_t>(std::max(got, 0));
          }};
}

/// What the callbacks work with.
struct Service {
  HttpServer::Answer answer;
  std::chrono::milliseconds patience;
  std::filesystem::path password_file;
};

/// Whether a request proves to know the password, if there is one. The file is read each time, so
/// that a new password counts at once.
bool is_let_in(mg_connection* connection, const std::filesystem::path& password_file) {
  return password_file.empty() ||
         mg_check_digest_access_authentication(connection, page_realm, password_file.c_str()) > 0;
}

/// The server's answer to one request; civetweb's callbacks are C, and nothing may be thrown
/// through them.
int answer_request(mg_connection* connection) noexcept {
  const mg_request_info& info = *mg_get_request_info(connection);
  const auto& [answer, patience, password_file] = *static_cast<const Service*>(info.user_data);
  if (!is_let_in(connection, password_file)) {
    mg_send_digest_access_authentication_request(connection, page_realm);
    return 401;
  }
  Request request = head_from(info);
  Response response;
  if (is_of_type(request.header("Content-Type").value_or(""), upload_type)) {
    request.upload = upload_from(connection, info.content_length);
    response = answer(request);
  } else if (auto body = read_body(connection, info.content_length, patience)) {
    request.body = *std::move(body);
    response = answer(request);
  } else {
    response = problem({.code = "too-large",
                        .detail = "a body is at most " + std::to_string(most_body) +
                                  " bytes, and comes without delay",
                        .hint = "Send the settings only."});
  }
  const int status = response.status;
  send(connection, request.method, std::move(response));
  return status;
}

/// Errors that civetweb finds itself: heads that are malformed, too large or too slow.
int answer_error(mg_connection* connection, int /*status*/, const char* message) noexcept {
  send(connection, "GET", problem({.code = "bad-request", .detail = message, .hint = ""}));
  return 0;
}

int keep_message(const mg_connection* connection, const char* message) noexcept {
  if (connection == nullptr) {  // about the server; those about one client's mistakes are dropped
    log::warning("http", message);
  }
  return 1;
}

}  // namespace

struct HttpServer::Server {
  Service service;
  std::string address = {};  // that reaches this server from this machine
  mg_context* context = nullptr;
};

HttpServer::HttpServer(const HttpOptions& options, Answer answer)
    : server_(std::make_unique<Server>(Server{.service = {.answer = std::move(answer),
                                                          .patience = options.patience,
                                                          .password_file = options.password_file},
                                              .address = options.address == "0.0.0.0" ? "127.0.0.1"
                                                         : options.address == "::"
                                                             ? "::1"
                                                             : options.address})) {
  if (!options.password_file.empty() && ::access(options.password_file.c_str(), R_OK) != 0) {
    throw Error("bad-password-file", options.password_file.string() + ": cannot be read",
                "`octurn password` makes it; the user that this program runs as must own it.");
  }
  const bool v6 = options.address.find(':') != std::string::npos;
  const std::string address = v6 ? "[" + options.address + "]" : options.address;
  const std::string listening = address + ":" + std::to_string(options.port);
  const std::string patience = std::to_string(options.patience.count());
  std::vector<const char*> settings{"listening_ports", listening.c_str(), "request_timeout_ms",
                                    patience.c_str()};
  for (const auto& [name, value] : fixed_options) {
    settings.insert(settings.end(), {name, value});
  }
  settings.push_back(nullptr);

  mg_callbacks callbacks{};
  callbacks.begin_request = answer_request;
  callbacks.http_error = answer_error;
  callbacks.log_message = keep_message;
  mg_init_library(0);
  std::array<char, 256> reason{};
  mg_init_data init{.callbacks = &callbacks,
                    .user_data = &server_->service,
                    .configuration_options = settings.data()};
  mg_error_data error{};  // what else it holds changes with civetweb's version
  error.text = reason.data();
  error.text_buffer_size = reason.size();
  server_->context = mg_start2(&init, &error);
  if (server_->context == nullptr) {
    mg_exit_library();
    throw Error("listen-failed", "cannot listen on " + listening + ": " + reason.data(),
                "Another program may use the port: choose one with --port, or 0 for any.");
  }
}

HttpServer::~HttpServer() {
  // civetweb looks whether it shall stop only between connections, or after 2 s without one: so it
  // gets connections until it has.
  const int own_port = port();
  const std::future<void> stopped = std::async(std::launch::async, mg_stop, server_->context);
  while (stopped.wait_for(std::chrono::milliseconds(5)) != std::future_status::ready) {
    std::array<char, 256> ignored{};
    if (mg_connection* const connection = mg_connect_client(server_->address.c_str(), own_port, 0,
                                                            ignored.data(), ignored.size())) {
      mg_close_connection(connection);
    }
  }
  mg_exit_library();
}

int HttpServer::port() const {
  mg_server_port port{};
  mg_get_server_ports(server_->context, 1, &port);
  return port.port;
}

}  // namespace octurn
