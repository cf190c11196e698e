#include "http/http_server.hpp"

#include <civetweb.h>
#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <future>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "log.hpp"
#include "support/http_client.hpp"
#include "support/patience.hpp"
#include "support/temporary_folder.hpp"
#include "support/thrown_error.hpp"

namespace octurn {
namespace {

using namespace std::chrono_literals;

/// Options of a server whose patience with slow clients is longer than any test.
const HttpOptions patient{.address = "127.0.0.1", .port = 0, .request_timeout = 1h};

/// Responds with the request as JSON.
Response echo(const Request& request) {
  nlohmann::json said{{"method", request.method}, {"path", request.path}, {"body", request.body}};
  for (const auto& [name, value] : request.headers) {
    said["headers"][name] = value;
  }
  return {.headers = {{"Content-Type", "application/json"}}, .body = said.dump()};
}

Response echo_host(const Request& request) {
  return {.body = std::string(request.header("Host").value_or(""))};
}

nlohmann::json said(const Reply& reply) { return nlohmann::json::parse(reply.body); }

TEST(HttpServer, HandsOverTheWholeRequest) {
  const HttpServer server(patient, echo);
  const Reply reply =
      request(server.port(), "POST", "/a%20b/c?query=1", R"({"x":1})", {{"X-Test", "yes"}});
  EXPECT_EQ(reply.status, 200);
  EXPECT_EQ(said(reply)["method"], "POST");
  EXPECT_EQ(said(reply)["path"], "/a b/c");
  EXPECT_EQ(said(reply)["body"], R"({"x":1})");
  EXPECT_EQ(said(reply)["headers"]["X-Test"], "yes");
}

TEST(HttpServer, TakesABodyInChunks) {
  const HttpServer server(patient, echo);
  const Reply reply = reply_to(server.port(),
                               "POST / HTTP/1.1\r\nHost: localhost\r\nTransfer-Encoding: chunked"
                               "\r\n\r\n3\r\nabc\r\n2\r\nde\r\n0\r\n\r\n");
  EXPECT_EQ(said(reply)["body"], "abcde");
}

TEST(HttpServer, SaysTheLengthAndWhatEveryPageMayDo) {
  const HttpServer server(patient, echo);
  const Reply reply = request(server.port(), "GET", "/");
  EXPECT_EQ(reply.header("Content-Length"), std::to_string(reply.body.size()));
  EXPECT_EQ(reply.header("X-Content-Type-Options"), "nosniff");
  EXPECT_NE(reply.header("Content-Security-Policy").find("default-src 'self'"), std::string::npos);
  EXPECT_EQ(reply.header("Access-Control-Allow-Origin"), "");
}

TEST(HttpServer, AnswersAHeadWithoutTheBody) {
  const HttpServer server(patient, echo);
  const Reply whole = request(server.port(), "GET", "/");
  const Reply head = request(server.port(), "HEAD", "/");
  EXPECT_EQ(head.status, 200);
  EXPECT_EQ(head.body, "");
  // The body repeats the method, and "HEAD" is one letter longer than "GET".
  EXPECT_EQ(std::stoul(head.header("Content-Length")), whole.body.size() + 1);
}

/// Sends a request on a kept-alive connection, and reads its response, whose body has 4 bytes.
std::string ask_on(const FileDescriptor& socket) {
  send_text(socket, "GET / HTTP/1.1\r\nHost: localhost\r\nConnection: keep-alive\r\n\r\n");
  std::string told;
  for (char byte = 0;
       !told.ends_with("\r\n\r\nbody") && ::recv(socket.number(), &byte, 1, 0) == 1;) {
    told += byte;
  }
  return told;
}

TEST(HttpServer, KeepsTheConnectionOfWhoAsksForIt) {
  const HttpServer server(patient, [](const Request&) { return Response{.body = "body"}; });
  const FileDescriptor socket = connected(server.port());
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(reply_from(ask_on(socket)).header("Connection"), "keep-alive");
  }
  send_text(socket, "GET / HTTP/1.1\r\nHost: localhost\r\n\r\n");
  EXPECT_EQ(reply_from(receive_all(socket)).header("Connection"), "close");
}

TEST(HttpServer, ClosesWhereABodyMayBeUnread) {
  const HttpServer server(patient, [](const Request&) { return Response{.status = 409}; });
  const Reply chunked = reply_to(server.port(),
                                 "GET / HTTP/1.1\r\nHost: localhost\r\nConnection: keep-alive\r\n"
                                 "Transfer-Encoding: chunked\r\n\r\n0\r\n\r\n");
  EXPECT_EQ(chunked.header("Connection"), "close");
  const Reply reply =
      reply_to(server.port(),
               "PUT / HTTP/1.1\r\nHost: localhost\r\nConnection: keep-alive\r\n"
               "Content-Type: application/octet-stream\r\nContent-Length: 4\r\n\r\nbody");
  EXPECT_EQ(reply.header("Connection"), "close");
}

// Each idle connection holds a thread. They are cut when another client needs one.
TEST(HttpServer, AnswersOthersBesideKeptConnections) {
  const HttpServer server(patient, [](const Request&) { return Response{.body = "body"}; });
  std::vector<FileDescriptor> idle;
  for (int i = 0; i < 60; ++i) {
    idle.push_back(connected(server.port()));
    EXPECT_EQ(reply_from(ask_on(idle.back())).status, 200);
  }
  EXPECT_EQ(request(server.port(), "GET", "/").status, 200);
}

TEST(HttpServer, LeavesPreflightsToItsOwner) {
  const HttpServer server(patient, echo);
  const Reply reply = request(server.port(), "OPTIONS", "/", "",
                              {{"Origin", "http://evil.example"},
                               {"Access-Control-Request-Method", "POST"},
                               {"Access-Control-Request-Headers", "content-type"}});
  EXPECT_EQ(said(reply)["method"], "OPTIONS");
  EXPECT_EQ(reply.header("Access-Control-Allow-Origin"), "");
  EXPECT_EQ(reply.header("Access-Control-Allow-Methods"), "");
}

TEST(HttpServer, SendsAPartOfAFile) {
  const TemporaryFolder folder;
  std::string content(300'000, '\0');
  for (std::size_t i = 0; i < content.size(); ++i) {
    content[i] = static_cast<char>(i * 31 >> 3);
  }
  put(folder.path() / "file", content);
  const HttpServer server(patient, [&](const Request&) {
    return Response{
        .status = 206,
        .body = FileSlice{FileDescriptor(::open((folder.path() / "file").c_str(), O_RDONLY)), 1000,
                          250'000}};
  });
  const Reply reply = request(server.port(), "GET", "/");
  EXPECT_EQ(reply.status, 206);
  EXPECT_EQ(reply.header("Content-Length"), "250000");
  EXPECT_TRUE(reply.body == content.substr(1000, 250'000));
}

TEST(HttpServer, RefusesABodyThatIsTooLarge) {
  const HttpServer server(patient, echo);
  EXPECT_EQ(request(server.port(), "POST", "/", std::string(65536, ' ')).status, 200);
  EXPECT_EQ(request(server.port(), "POST", "/", std::string(65537, ' ')).status, 413);
  const Reply announced = reply_to(server.port(),
                                   "POST / HTTP/1.1\r\nHost: localhost\r\n"
                                   "Content-Length: 99999999999999\r\n\r\n");
  EXPECT_EQ(announced.status, 413);
  std::string chunks = "POST / HTTP/1.1\r\nHost: localhost\r\nTransfer-Encoding: chunked\r\n\r\n";
  for (int i = 0; i < 80; ++i) {
    chunks += "400\r\n" + std::string(1024, 'x') + "\r\n";
  }
  EXPECT_EQ(reply_to(server.port(), chunks + "0\r\n\r\n").status, 413);
}

TEST(HttpServer, LeavesAnUploadToItsOwner) {
  const HttpServer server(patient, [](const Request& request) {
    std::array<std::byte, 1000> part{};
    std::size_t bytes = 0;
    for (std::size_t got = 1; got > 0; bytes += got) {
      got = request.upload.read(part);
    }
    return Response{.body = std::to_string(bytes) + " of " +
                            std::to_string(request.upload.length.value_or(0)) + " not " +
                            std::to_string(request.body.size())};
  });
  const std::string head =
      "PUT / HTTP/1.1\r\nHost: localhost\r\nContent-Length: 200000\r\n"
      "Content-Type: application/octet-stream\r\n\r\n";
  EXPECT_EQ(reply_to(server.port(), head + std::string(200'000, 'x')).body,
            "200000 of 200000 not 0");
}

TEST(HttpServer, AnswersAnUploadThatItDoesNotWant) {
  const HttpServer server(patient, [](const Request&) { return Response{.status = 409}; });
  const std::string head =
      "PUT / HTTP/1.1\r\nHost: localhost\r\nContent-Length: 5000000\r\n"
      "Content-Type: application/octet-stream\r\n\r\n";
  EXPECT_EQ(reply_to(server.port(), head + std::string(5'000'000, 'x')).status, 409);
}

TEST(HttpServer, RefusesMalformedHeadsAndStaysUp) {
  const HttpServer server(patient, echo);
  const std::string host = "Host: localhost\r\n\r\n";
  for (const std::string& text : std::vector<std::string>{
           "\r\n\r\n", "GET\r\n\r\n", "GET / HTTP/9.9\r\n" + host, "BREW / HTTP/1.1\r\n" + host,
           "GET / HTTP/1.1\r\nHost localhost\r\n\r\n", std::string("\0\1\2\3\r\n\r\n", 8),
           "POST / HTTP/1.1\r\nContent-Length: -5\r\n" + host,
           "POST / HTTP/1.1\r\nContent-Length: abc\r\n" + host,
           "GET /" + std::string(20000, 'a') + " HTTP/1.1\r\n" + host,
           "GET / HTTP/1.1\r\nX: " + std::string(20000, 'a') + "\r\n" + host}) {
    const FileDescriptor socket = connected(server.port());
    send_text(socket, text);
    ::shutdown(socket.number(), SHUT_WR);  // so that the server waits for nothing more
    const Reply reply = reply_from(receive_all(socket));
    EXPECT_TRUE(reply.status == 0 || reply.status >= 400)
        << reply.status << " for " << text.substr(0, 60);
  }
  EXPECT_EQ(request(server.port(), "GET", "/").status, 200);
}

TEST(HttpServer, EndsConnectionsThatStall) {
  const HttpServer server({.address = "127.0.0.1", .port = 0, .request_timeout = 300ms}, echo);
  for (const char* const text :
       {"", "GET / HTT", "POST / HTTP/1.1\r\nHost: localhost\r\nContent-Length: 10\r\n\r\n1234"}) {
    const FileDescriptor socket = connected(server.port());
    send_text(socket, text);
    receive_all(socket);  // returns when the server closes
  }
}

// The server's patience is longer than the test, so it answers beside stalled clients or never.
TEST(HttpServer, AnswersOthersWhileSomeStall) {
  const HttpServer server(patient, echo);
  std::vector<FileDescriptor> stalled;
  for (int i = 0; i < 10; ++i) {
    stalled.push_back(connected(server.port()));
    send_text(stalled.back(), "GET / HTTP/1.1\r\nHost: l");
  }
  EXPECT_EQ(request(server.port(), "GET", "/").status, 200);
}

TEST(HttpServer, SaysThatThePortIsTaken) {
  const HttpServer first(patient, echo);
  const Error error =
      error_thrown_by([&] { HttpServer({.address = "127.0.0.1", .port = first.port()}, echo); });
  EXPECT_EQ(error.code(), ErrorCode::listen_failed);
  EXPECT_NE(std::string(error.what()).find(std::to_string(first.port())), std::string::npos);
  EXPECT_NE(error.hint().find("--port"), std::string::npos);
}

TEST(HttpServer, WaitsForAPortThatIsFreedSoon) {
  std::optional<HttpServer> first(std::in_place, patient, echo);
  const int port = first->port();
  std::future<int> second = std::async(std::launch::async, [port] {
    return HttpServer({.address = "127.0.0.1", .port = port, .bind_patience = patience}, echo)
        .port();
  });
  while (log::recent().find("trying again") == std::string::npos) {
    ASSERT_EQ(second.wait_for(1ms), std::future_status::timeout) << "it listens on a taken port";
  }
  first.reset();
  EXPECT_EQ(second.get(), port);
}

TEST(HttpServer, TakesTheHostThatATrustedProxyForwards) {
  HttpOptions options = patient;
  const auto host = [&] {
    const HttpServer server(options, echo_host);
    return request(server.port(), "GET", "/", "", {{"X-Forwarded-Host", "scanner.example"}}).body;
  };
  EXPECT_TRUE(host().starts_with("localhost:"));
  options.trusted_proxies = {"127.0.0.1"};
  EXPECT_EQ(host(), "scanner.example");
}

TEST(HttpServer, SaysWhyItCannotListenOnIPv6) {
  if (mg_check_feature(8) == 0) {
    const Error error = error_thrown_by([] { HttpServer({.address = "::1", .port = 0}, echo); });
    EXPECT_EQ(error.code(), ErrorCode::listen_failed);
    EXPECT_NE(std::string(error.what()).find("IPv6"), std::string::npos) << error.what();
  } else {
    HttpServer({.address = "::1", .port = 0}, echo);
  }
}

TEST(HttpServer, RefusesARequestWhoseLengthIsInDoubtAndReadsNoneAfterIt) {
  const HttpServer server(patient, echo);
  for (const char* const lengths :
       {"Content-Length: 0x5\r\n", "Content-Length: 0\r\nContent-Length: 44\r\n"}) {
    const Reply reply = reply_to(
        server.port(), std::string("GET /first HTTP/1.1\r\nHost: localhost\r\n"
                                   "Connection: keep-alive\r\n") +
                           lengths + "\r\nGET /second HTTP/1.1\r\nHost: localhost\r\n\r\n");
    EXPECT_EQ(reply.status, 400) << lengths;
    EXPECT_EQ(reply.header("Connection"), "close") << lengths;
    EXPECT_EQ(reply.body.find("second"), std::string::npos) << reply.body;
  }
}

TEST(HttpServer, RefusesControlCharactersOfATarget) {
  const HttpServer server(patient, echo);
  const auto status = [&](const std::string& target) {
    return request(server.port(), "GET", target).status;
  };
  for (const char* const target : {"/status%00", "/status%00.png", "/%00", "/a%0Ab", "/a%0D%0Ab",
                                   "/a%1f", "/a%7F", "/a?leaf=1%00.png", "/a/%2e%2e", "/%2E/a"}) {
    EXPECT_EQ(status(target), 400) << target;
  }
  for (const char* const target : {"/gr%C3%BCn", "/a%2500", "/a%", "/a%0", "/a%20?b=%0A"}) {
    EXPECT_EQ(status(target), 200) << target;
  }
}

/// Lowers this process's limit of open files to a number of free ones, for its lifetime.
class FewDescriptors {
 public:
  explicit FewDescriptors(rlim_t free) {
    ::getrlimit(RLIMIT_NOFILE, &before_);
    const FileDescriptor next(::dup(STDIN_FILENO));
    const rlimit few{.rlim_cur = static_cast<rlim_t>(next.number()) + free,
                     .rlim_max = before_.rlim_max};
    ::setrlimit(RLIMIT_NOFILE, &few);
  }
  ~FewDescriptors() { ::setrlimit(RLIMIT_NOFILE, &before_); }
  FewDescriptors(const FewDescriptors&) = delete;
  FewDescriptors& operator=(const FewDescriptors&) = delete;

 private:
  rlimit before_{};
};

/// The code of the error that starting a server throws; empty if it starts.
std::string code_at_start(const HttpOptions& options, rlim_t free_descriptors) try {
  const FewDescriptors few(free_descriptors);
  const HttpServer server(options, echo);
  return "";
} catch (const Error& error) {
  return std::string(to_string(error.code()));
}

TEST(HttpServer, LeavesNothingBehindWhereverItsStartFails) {
  const HttpOptions options{.address = "127.0.0.1", .port = HttpServer(patient, echo).port()};
  std::set<std::string> codes;
  for (rlim_t free = 0; free < 4; ++free) {  // threads that start may need some for a moment
    codes.insert(code_at_start(options, free));
    EXPECT_EQ(code_at_start(options, 100), "") << "the port is free after " << free;
  }
  EXPECT_TRUE(codes.contains("listen-failed")) << "civetweb does not start";
  EXPECT_TRUE(codes.contains("no-descriptors")) << "civetweb has started";
}

TEST(HttpServer, SaysThatAnAddressIsNone) {
  EXPECT_EQ(code_thrown_by([] { HttpServer({.address = "300.1.1.1", .port = 0}, echo); }),
            "listen-failed");
}

}  // namespace
}  // namespace octurn
