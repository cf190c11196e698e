// Clients that are slow, too many, or gone before their request is complete.

#include <gtest/gtest.h>

#include <array>
#include <atomic>
#include <chrono>
#include <string>
#include <thread>
#include <vector>

#include "http/http_server.hpp"
#include "support/http_client.hpp"

namespace octurn {
namespace {

using namespace std::chrono_literals;

constexpr std::size_t endless = std::size_t{1} << 40U;

/// Streams "/stream" without end, reads an upload to its end, and answers anything else at once.
Response answer(const Request& request) {
  if (request.path == "/stream") {
    ByteStream stream{.length = endless};
    stream.make = std::packaged_task<void(const ByteSink&)>([](const ByteSink& sink) {
      const std::vector<std::byte> part(100'000);
      while (sink(part)) {
      }
    });
    return {.body = std::move(stream)};
  }
  if (request.path == "/upload") {
    std::vector<std::byte> part(100);
    std::size_t bytes = 0;
    for (std::size_t got = 1; got > 0; bytes += got) {
      got = request.upload.read(part);
    }
    return {.body = std::to_string(bytes)};
  }
  return {.body = "the page"};
}

HttpServer server_with(std::chrono::milliseconds patience) {
  return {{.address = "127.0.0.1", .port = 0, .request_timeout = patience}, answer};
}

std::string post(const std::string& path, const std::string& type, const std::string& length) {
  return "POST " + path + " HTTP/1.1\r\nHost: localhost\r\nContent-Type: " + type +
         "\r\nContent-Length: " + length + "\r\n\r\n";
}

struct SlowKind {
  std::string name;
  std::string says;
};

const std::vector<SlowKind> slow_kinds{
    {"Silent", ""},
    {"HalfAHead", "GET / HTTP/1.1\r\nHost: lo"},
    {"NoBody", post("/", "application/json", "300")},
    {"HugeBody", post("/", "application/octet-stream", "1000000000")},
    {"Upload", post("/upload", "application/octet-stream", "1000000000")},
    {"Reader", "GET /stream HTTP/1.1\r\nHost: localhost\r\n\r\n"}};

class SlowClients : public ::testing::TestWithParam<SlowKind> {};

// The server's patience is an hour, so it answers while the slow clients stay connected.
TEST_P(SlowClients, LeaveThePageToOthers) {
  for (const bool one_address : {true, false}) {
    const HttpServer server = server_with(1h);
    std::vector<FileDescriptor> slow;
    for (std::uint32_t i = 0; i < 200; ++i) {
      const std::uint32_t address = INADDR_LOOPBACK + (one_address ? 1 : 1 + i);
      slow.push_back(connected_from(address, server.port()));
      send_text(slow.back(), GetParam().says);
    }
    EXPECT_EQ(request(server.port(), "GET", "/").body, "the page");
    EXPECT_EQ(request(server.port(), "POST", "/", "{}").body, "the page");
  }
}

INSTANTIATE_TEST_SUITE_P(Each, SlowClients, ::testing::ValuesIn(slow_kinds),
                         [](const auto& kind) { return kind.param.name; });

/// Sends a byte every 20 ms until the connection ends.
void drip(const FileDescriptor& socket) {
  while (::send(socket.number(), "x", 1, MSG_NOSIGNAL) == 1) {
    std::this_thread::sleep_for(20ms);
  }
}

class Drips : public ::testing::TestWithParam<std::string> {};

TEST_P(Drips, EndThoughEachByteComesSoon) {
  const HttpServer server = server_with(300ms);
  const FileDescriptor socket = connected(server.port());
  send_text(socket, GetParam());
  drip(socket);  // ends when the server closes the connection
}

INSTANTIATE_TEST_SUITE_P(
    Each, Drips,
    ::testing::Values("GET / HTTP/1.1\r\nX: ", post("/", "application/json", "60000"),
                      post("/", "application/json", "99999999999"),
                      post("/", "application/octet-stream", "99999999999"),
                      post("/upload", "application/octet-stream", "99999999999")));

// On a busy machine the time may be over before the server has read the head; then it only closes.
TEST(SlowClient, IsToldThatItsBodyCameTooSlowly) {
  const HttpServer server = server_with(300ms);
  int status = 0;
  while (status == 0) {
    status = reply_to(server.port(), post("/", "application/json", "300") + "{").status;
  }
  EXPECT_EQ(status, 408);
}

TEST(SlowReader, IsDroppedEvenIfItReadsAByteNowAndThen) {
  std::atomic<bool> ended = false;
  const HttpServer server(
      {.address = "127.0.0.1", .port = 0, .request_timeout = 300ms}, [&](const Request& request) {
        Response response = answer(request);
        auto& stream = std::get<ByteStream>(response.body);
        stream.make = std::packaged_task<void(const ByteSink&)>([&](const ByteSink& sink) {
          const std::vector<std::byte> part(100'000);
          while (sink(part)) {
          }
          ended = true;
        });
        return response;
      });
  while (!ended) {  // as above, the server may close before the stream begins
    const FileDescriptor socket = connected(server.port());
    send_text(socket, "GET /stream HTTP/1.1\r\nHost: localhost\r\n\r\n");
    char byte = 0;
    while (!ended && ::recv(socket.number(), &byte, 1, 0) == 1) {
      std::this_thread::sleep_for(20ms);
    }
  }
}

TEST(SlowReader, IsLeftAtOnceWhenTheStreamIsStopped) {
  std::stop_source scan_starts;
  std::atomic<bool> streaming = false;
  std::atomic<bool> ended = false;
  const HttpServer server(
      {.address = "127.0.0.1", .port = 0, .request_timeout = 1h}, [&](const Request&) {
        ByteStream stream{.length = endless, .stop = scan_starts.get_token()};
        stream.make = std::packaged_task<void(const ByteSink&)>([&](const ByteSink& sink) {
          const std::vector<std::byte> part(32 << 20U);  // more than the kernel buffers
          streaming = true;
          streaming.notify_all();
          EXPECT_FALSE(sink(part));
          ended = true;
          ended.notify_all();
        });
        return Response{.body = std::move(stream)};
      });
  const FileDescriptor socket = connected(server.port());
  send_text(socket, "GET / HTTP/1.1\r\nHost: localhost\r\n\r\n");
  streaming.wait(false);
  scan_starts.request_stop();
  ended.wait(false);  // the reader has read nothing
}

class CutOff : public ::testing::TestWithParam<std::string> {};

// An incomplete request is refused and never reaches the handler.
TEST_P(CutOff, AsksForNothing) {
  std::atomic<int> asked = 0;
  const HttpServer server({.address = "127.0.0.1", .port = 0, .request_timeout = 1h},
                          [&](const Request&) {
                            ++asked;
                            return Response{};
                          });
  const FileDescriptor socket = connected(server.port());
  send_text(socket, GetParam());
  ::shutdown(socket.number(), SHUT_WR);
  EXPECT_EQ(reply_from(receive_all(socket)).status, 400);
  EXPECT_EQ(asked, 0);
}

const std::string chunked =
    "POST / HTTP/1.1\r\nHost: localhost\r\nContent-Type: application/json\r\n"
    "Transfer-Encoding: chunked\r\n\r\n";

INSTANTIATE_TEST_SUITE_P(Each, CutOff,
                         ::testing::Values(post("/", "application/json", "300"),
                                           post("/", "application/json", "300") + "{}",
                                           chunked + "zz\r\n{}\r\n0\r\n\r\n", chunked,
                                           chunked + "2\r\n{}\r\n", chunked + "10\r\n{}",
                                           chunked + "2\r\n{}xx0\r\n\r\n"));

TEST(AbsoluteTarget, IsAnsweredForTheHostThatItNames) {
  const HttpServer server({.address = "127.0.0.1", .port = 0}, [](const Request& request) {
    return Response{.body = request.path + " at " +
                            std::string(request.header("Host").value_or("nowhere"))};
  });
  const std::string host = "scanner.local:" + std::to_string(server.port());
  const Reply reply =
      reply_to(server.port(), "GET http://" + host + "/a?b=1 HTTP/1.1\r\nHost: other\r\n\r\n");
  EXPECT_EQ(reply.body, "/a at " + host);
}

TEST(AbsoluteTarget, IsRefusedWithAReasonIfItIsNotOfThisServer) {
  std::atomic<int> asked = 0;
  const HttpServer server({.address = "127.0.0.1", .port = 0}, [&](const Request&) {
    ++asked;
    return Response{};
  });
  const std::string rest = " HTTP/1.1\r\nHost: localhost\r\nConnection: keep-alive\r\n\r\n";
  for (const auto& [target, status] :
       {std::pair("http://localhost:1/a", 421), std::pair("https://localhost/", 421),
        std::pair("http://evil.example:1/", 421), std::pair("*", 400)}) {
    const Reply reply = reply_to(server.port(), std::string("GET ") + target + rest);
    EXPECT_EQ(reply.status, status) << target;
    EXPECT_NE(reply.body.find(target), std::string::npos) << reply.body;
    EXPECT_EQ(reply.header("Connection"), "close") << target;
  }
  EXPECT_EQ(asked, 0);
  const FileDescriptor socket = connected(server.port());
  send_text(socket, "GET /a" + rest + "GET http://localhost:1/b" + rest);
  const std::string both = receive_all(socket);
  EXPECT_NE(both.find("HTTP/1.1 200"), std::string::npos) << both;
  EXPECT_NE(both.find("HTTP/1.1 421"), std::string::npos) << both;
}

}  // namespace
}  // namespace octurn
