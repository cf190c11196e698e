#include "http/http_server.hpp"

#include <civetweb.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdint>
#include <future>
#include <latch>
#include <stop_token>
#include <thread>
#include <utility>
#include <vector>

#include "http/json_body.hpp"
#include "http/login.hpp"
#include "http/same_origin.hpp"
#include "log.hpp"
#include "octurn/error.hpp"

namespace octurn {

/// How long a connection is kept for a next request.
constexpr int idle_seconds = 5;

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

  /// @throws Error "bad-request"  if a program in C may take a part of the target for the whole
  void expect_clear_target(const std::string& path) const;

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

/// State that civetweb's callbacks use. A class has it as a member, so it is not in the anonymous
/// namespace.
struct HttpService {
  HttpServer::Answer answer = {};
  std::optional<Login> login = {};  // set before the server starts
  const AccessKeys* keys = nullptr;
  HttpServer::Gate gate = {};
  std::vector<std::string> trusted_proxies = {};
  std::latch started{1};  // released once `guard` exists, or the server has failed to start
  std::optional<ConnectionGuard> guard = {};

  /// @return null if the server has failed to start
  ConnectionGuard* wait_for_guard() {
    started.wait();
    return guard ? &*guard : nullptr;
  }
};

namespace {

/// civetweb occupies a thread for each open connection, with a stack of 100 KiB in Debian's build
/// and a buffer of max_request_size. The guard cuts connections before all threads are taken.
constexpr std::size_t threads = 32;
constexpr std::size_t spare_threads = 4;

constexpr std::array<std::pair<const char*, const char*>, 8> fixed_options{{
    {"max_request_size", "16384"},       // of the head, bytes
    {"enable_keep_alive", "yes"},        // Exchange decides
    {"enable_auth_domain_check", "no"},  // any host in an absolute request target
    {"decode_url", "no"},                // a decoded U+0000 would end the path
    {"tcp_nodelay", "1"},
    {"enable_directory_listing", "no"},
    {"access_control_allow_origin", ""},
    {"access_control_allow_methods", ""},
}};

HttpService& to_service(const mg_connection* connection) {
  return *static_cast<HttpService*>(mg_get_user_data(mg_get_context(connection)));
}

/// The gate's answer, or the refusal of missing or wrong credentials; nothing if the request is
/// admitted.
/// @param address  of the client
std::optional<Response> refusal(mg_connection& connection, const Request& request,
                                std::string address, HttpService& service) {
  if (auto answer = service.gate ? service.gate(request) : std::nullopt) {
    return answer;
  }
  if (const auto key = key_in(request); key && service.keys != nullptr) {
    return refuse_key(*service.keys, request, *key);
  }
  const mg_request_info& info = *mg_get_request_info(&connection);
  std::string target = info.request_uri != nullptr ? info.request_uri : "";
  if (info.query_string != nullptr) {
    target.append("?").append(info.query_string);
  }
  const bool is_page_load =
      request.header("Accept").value_or("").find("text/html") != std::string_view::npos;
  return service.login->refusal({.method = request.method,
                                 .target = std::move(target),
                                 .address = std::move(address),
                                 .authorization = request.header("Authorization"),
                                 .reader = is_page_load ? Reader::person : Reader::program},
                                std::chrono::steady_clock::now());
}

/// The answer to a request whose head is read.
Response answer_to(Request& request, Exchange& exchange, const HttpServer::Answer& answer) {
  try {
    exchange.expect_clear_length();
    exchange.expect_clear_target(request.path);
    if (is_upload(request)) {
      request.upload = exchange.upload();
    } else {
      request.body = exchange.read_body();
    }
  } catch (const Error& error) {
    return problem({.code = error.code(), .detail = error.what(), .hint = error.hint()});
  }
  return answer(request);
}

// civetweb's callbacks are C, and nothing may be thrown through them.

int take_up(const mg_connection* connection, void** /*data*/) noexcept {
  if (ConnectionGuard* const guard = to_service(connection).wait_for_guard()) {
    guard->take_up();
  }
  return 0;
}

int answer_request(mg_connection* connection) noexcept try {
  HttpService& service = to_service(connection);
  ConnectionGuard* const guard = service.wait_for_guard();
  if (guard == nullptr) {
    return 503;  // the connection closes
  }
  Exchange exchange(*connection, *guard);
  Request request = exchange.head();
  std::string address = mg_get_request_info(connection)->remote_addr;
  take_forwarded(request, address, service.trusted_proxies);
  std::optional<Response> refused = refusal(*connection, request, std::move(address), service);
  Response response = refused ? std::move(*refused) : answer_to(request, exchange, service.answer);
  const int status = response.status;
  exchange.send(request.method, std::move(response));
  return status;
} catch (const std::exception& error) {
  log::error("http", std::string("a request has failed: ") + error.what());
  return 500;  // the connection closes
}

/// Answers errors that civetweb detects: heads that are malformed, too large or too slow.
int answer_error(mg_connection* connection, int /*status*/, const char* message) noexcept try {
  if (ConnectionGuard* const guard = to_service(connection).wait_for_guard()) {
    Exchange(*connection, *guard)
        .send("GET", problem({.code = ErrorCode::bad_request, .detail = message, .hint = ""}));
    mg_set_user_connection_data(connection, guard);  // not null: it is answered
  }
  return 0;
} catch (const std::exception& error) {
  log::error("http", std::string("a refusal has failed: ") + error.what());
  return 0;
}

/// Answers a request for which civetweb calls nothing: its target is `*`, or a URL whose port is
/// not this server's.
void answer_foreign_target(const mg_connection* connection) noexcept try {
  const mg_request_info* const info = mg_get_request_info(connection);
  if (info == nullptr || info->request_uri == nullptr || info->local_uri != nullptr ||
      mg_get_user_connection_data(connection) != nullptr) {
    return;
  }
  if (ConnectionGuard* const guard = to_service(connection).wait_for_guard()) {
    const std::string target = info->request_uri;
    const bool is_url = target.find("://") != std::string::npos;
    Exchange(const_cast<mg_connection&>(*connection), *guard)
        .send("GET", problem({.code = is_url ? ErrorCode::wrong_host : ErrorCode::bad_request,
                              .detail = "the request is for " + target,
                              .hint = "Ask for a path, such as /api/v1/status."}));
  }
} catch (const std::exception& error) {
  log::error("http", std::string("a refusal has failed: ") + error.what());
}

int keep_message(const mg_connection* connection, const char* message) noexcept {
  if (connection == nullptr) {  // about the server; messages about one client are dropped
    log::warning("http", message);
  }
  return 1;
}

/// The address at which this machine reaches its own server that listens at `address`.
std::string reaching(const std::string& address) {
  if (address == "0.0.0.0") {
    return "127.0.0.1";
  }
  return address == "::" ? "::1" : address;
}

mg_context* start_civetweb(const std::string& listening, const HttpOptions& options,
                           HttpService& service) {
  const std::string request_timeout = std::to_string(options.request_timeout.count());
  const std::string num_threads = std::to_string(threads);
  const std::string idle = std::to_string(idle_seconds * 1000);
  std::vector<const char*> settings{
      "listening_ports", listening.c_str(),   "request_timeout_ms",    request_timeout.c_str(),
      "num_threads",     num_threads.c_str(), "keep_alive_timeout_ms", idle.c_str()};
  for (const auto& [name, value] : fixed_options) {
    settings.insert(settings.end(), {name, value});
  }
  settings.push_back(nullptr);

  mg_callbacks callbacks{};
  callbacks.init_connection = take_up;
  callbacks.begin_request = answer_request;
  callbacks.http_error = answer_error;
  callbacks.connection_close = answer_foreign_target;
  callbacks.log_message = keep_message;
  mg_init_library(0);
  std::array<char, 256> reason{};
  mg_init_data init{
      .callbacks = &callbacks, .user_data = &service, .configuration_options = settings.data()};
  mg_error_data error{};  // its other members depend on civetweb's version
  error.text = reason.data();
  error.text_buffer_size = reason.size();
  mg_context* const context = mg_start2(&init, &error);
  if (context == nullptr) {
    mg_exit_library();
    throw Error(ErrorCode::listen_failed, "cannot listen on " + listening + ": " + reason.data(),
                "Another program may use the port: choose one with --port, or 0 for any.");
  }
  return context;
}

}  // namespace

/// A server that runs as soon as `start` has returned. The destructor stops as much of it as has
/// started: civetweb's threads use `service_`.
class HttpServer::Server {
 public:
  Server() = default;
  ~Server() {
    if (context_ != nullptr) {
      stop();
    }
  }
  Server(const Server&) = delete;
  Server& operator=(const Server&) = delete;

  HttpService& service() { return service_; }

  /// @throws Error "listen-failed", "no-descriptors"
  void start(const HttpOptions& options) {
    const bool v6 = options.address.find(':') != std::string::npos;
    const std::string address = v6 ? "[" + options.address + "]" : options.address;
    address_ = reaching(options.address);
    if (v6 && mg_check_feature(8) == 0) {
      throw Error(ErrorCode::listen_failed,
                  "cannot listen on " + options.address + ": civetweb was built without IPv6",
                  "Choose an IPv4 address; 0.0.0.0 stands for all.");
    }
    context_ = start_when_port_is_free(address + ":" + std::to_string(options.port), options);
    defer_accept(port(), std::chrono::ceil<std::chrono::seconds>(options.request_timeout));
    service_.guard.emplace(port(), ConnectionLimits{.max_connections = threads - spare_threads,
                                                    .patience = options.request_timeout});
    service_.started.count_down();
  }

  int port() const {
    mg_server_port port{};
    mg_get_server_ports(context_, 1, &port);
    return port.port;
  }

 private:
  void stop() {
    if (service_.guard) {
      service_.guard->close();
    } else {
      service_.started.count_down();  // threads may wait for the guard already
    }
    // civetweb checks whether to stop only between connections, or after 2 s without one. Opening
    // connections until it has stopped makes that fast.
    const int own_port = port();
    accept_at_once(own_port);
    const std::future<void> stopped = std::async(std::launch::async, mg_stop, context_);
    while (stopped.wait_for(std::chrono::milliseconds(5)) != std::future_status::ready) {
      std::array<char, 256> ignored{};
      if (mg_connection* const connection =
              mg_connect_client(address_.c_str(), own_port, 0, ignored.data(), ignored.size())) {
        mg_close_connection(connection);
      }
    }
    mg_exit_library();
  }

  mg_context* start_when_port_is_free(const std::string& listening, const HttpOptions& options) {
    const auto deadline = std::chrono::steady_clock::now() + options.bind_patience;
    for (bool is_first = true;; is_first = false) {
      try {
        return start_civetweb(listening, options, service_);
      } catch (const Error& error) {
        if (std::chrono::steady_clock::now() >= deadline) {
          throw;
        }
        if (is_first) {
          log::warning("http", std::string(error.what()) + "; trying again");
        }
        std::this_thread::sleep_for(std::chrono::milliseconds(100));
      }
    }
  }

  static void accept_at_once(int port) {
    try {
      defer_accept(port, std::chrono::seconds(0));
    } catch (const Error& error) {
      log::warning("http", error.what());  // stopping takes longer
    }
  }

  HttpService service_ = {};
  std::string address_ = {};  // at which this machine reaches the server
  mg_context* context_ = nullptr;
};

HttpServer::HttpServer(const HttpOptions& options, Answer answer, const AccessKeys* keys, Gate gate)
    : server_(std::make_unique<Server>()) {
  const bool is_overridden = ::access(options.own_password_file.c_str(), F_OK) == 0;
  if (!options.password_file.empty() && !is_overridden &&
      ::access(options.password_file.c_str(), R_OK) != 0) {
    throw Error(ErrorCode::bad_password_file, options.password_file.string() + ": cannot be read",
                "`octurn password` makes it; the user that this program runs as must own it.");
  }
  HttpService& service = server_->service();
  service.answer = std::move(answer);
  service.keys = keys;
  service.gate = std::move(gate);
  service.trusted_proxies = options.trusted_proxies;
  service.login.emplace(options.password_file, options.own_password_file);
  server_->start(options);
}

HttpServer::~HttpServer() = default;

int HttpServer::port() const { return server_->port(); }

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

/// A path without its percent-encoding. It may contain U+0000.
std::string to_path(std::string_view target) {
  std::string path(target.size() + 1, '\0');
  const int length = mg_url_decode(target.data(), static_cast<int>(target.size()), path.data(),
                                   static_cast<int>(path.size()), 0);
  path.resize(static_cast<std::size_t>(std::max(length, 0)));
  return path;
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
                  .path = to_path(info.local_uri != nullptr ? info.local_uri : ""),
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

void Exchange::expect_clear_target(const std::string& path) const {
  const char* const query = mg_get_request_info(&connection_)->query_string;
  const auto is_control = [](char c) { return static_cast<unsigned char>(c) < ' ' || c == '\x7f'; };
  const std::string whole = path + "/";
  if (whole.find("/../") != std::string::npos || whole.find("/./") != std::string::npos) {
    throw Error(ErrorCode::bad_request, "a part of the address is . or ..",
                "Ask for a path, such as /api/v1/status.");
  }
  if (std::ranges::any_of(path, is_control) ||
      (query != nullptr && std::string_view(query).find("%00") != std::string_view::npos)) {
    throw Error(ErrorCode::bad_request, "the address contains a control character",
                "Ask for a path, such as /api/v1/status.");
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
