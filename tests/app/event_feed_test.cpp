#include "http/event_feed.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <string>
#include <thread>

#include "http/http_server.hpp"
#include "support/http_client.hpp"

namespace octurn {
namespace {

using namespace std::chrono_literals;

constexpr FeedLimits brisk{.max_watchers = 2, .poll_interval = 1ms, .heartbeat = 1h};

std::string to_text(std::span<const std::byte> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

/// Runs a stream until it ends or `wants_more` refuses. @return its text
std::string all_of(ByteStream stream, const std::function<bool(const std::string&)>& wants_more) {
  std::string told;
  stream.make([&](std::span<const std::byte> bytes) {
    told += to_text(bytes);
    return wants_more(told);
  });
  return told;
}

bool has(const std::string& text, std::string_view part) {
  return text.find(part) != std::string::npos;
}

TEST(EventFeed, TellsWhatIsAndThenWhatChanges) {
  int value = 1;
  EventFeed feed([&] { return std::vector<News>{{"status", std::to_string(value)}}; }, brisk);
  all_of(*feed.watch(""), [&](const std::string& told) {
    value = has(told, "data: 1\n") ? 2 : 1;
    return !has(told, "data: 2\n");
  });
  EXPECT_EQ(value, 2);
}

TEST(EventFeed, GoesOnWhereAClientWas) {
  EventFeed feed([] { return std::vector<News>{{"status", "1"}}; }, brisk);
  const auto until_event = [](const std::string& told) { return !has(told, "data:"); };
  const std::string first = all_of(*feed.watch(""), until_event);
  const std::size_t id = first.find("id: ") + 4;
  const std::string last = first.substr(id, first.find('\n', id) - id);
  feed.end();  // ends the stream, which has no event to send
  EXPECT_FALSE(has(all_of(*feed.watch(last), [](const std::string&) { return true; }), "data:"));
  EXPECT_TRUE(
      has(all_of(*feed.watch("another-1"), [](const std::string&) { return true; }), "data:"));
}

TEST(EventFeed, HoldsAPlaceForEachStream) {
  EventFeed feed([] { return std::vector<News>{}; }, brisk);
  std::optional<ByteStream> first = feed.watch("");
  const std::optional<ByteStream> second = feed.watch("");
  EXPECT_TRUE(first && second);
  EXPECT_FALSE(feed.watch(""));
  first.reset();
  EXPECT_TRUE(feed.watch(""));
}

TEST(EventFeed, HeartbeatDetectsDisconnect) {
  FeedLimits limits = brisk;
  limits.heartbeat = 1ms;
  EventFeed feed([] { return std::vector<News>{}; }, limits);
  all_of(*feed.watch(""), [](const std::string& told) { return !has(told, "event: heartbeat"); });
}

TEST(EventFeed, EndsAStreamAfterItsLifetime) {
  EXPECT_EQ(FeedLimits{}.lifetime, 10min);  // a revoked key has it no longer
  FeedLimits limits = brisk;
  limits.lifetime = 0ms;
  EventFeed feed([] { return std::vector<News>{}; }, limits);
  const std::string told = all_of(*feed.watch(""), [](const std::string&) { return true; });
  EXPECT_EQ(told, "retry: 1000\n\n");
}

TEST(EventFeed, EndsItsStreamsAtOnce) {
  EventFeed feed([] { return std::vector<News>{}; }, {.poll_interval = 1h, .heartbeat = 1h});
  std::atomic<bool> is_told = false;
  const std::jthread watcher([&] {
    all_of(*feed.watch(""), [&](const std::string&) {
      is_told = true;
      is_told.notify_all();
      return true;
    });
  });
  is_told.wait(false);
  feed.end();
}

TEST(EventFeed, EndsAStreamThatCannotLook) {
  EventFeed feed([]() -> std::vector<News> { throw std::runtime_error("no disk"); }, brisk);
  EXPECT_EQ(all_of(*feed.watch(""), [](const std::string&) { return true; }), "retry: 1000\n\n");
}

/// A server whose event streams send one event, and that also serves a page.
class EventServer {
 public:
  int port() const { return server_.port(); }

  /// Opens an event stream, and waits for its first event.
  FileDescriptor watch() const {
    FileDescriptor socket = connected(port());
    send_text(socket, "GET /events HTTP/1.1\r\nHost: localhost\r\n\r\n");
    std::string told;
    for (char byte = 0; !has(told, "data: 1\n\n") && ::recv(socket.number(), &byte, 1, 0) == 1;) {
      told += byte;
    }
    EXPECT_FALSE(has(told, "Content-Length"));
    return socket;
  }

  int status_of_one_more() const {
    const FileDescriptor socket = connected(port());
    send_text(socket, "GET /events HTTP/1.1\r\nHost: localhost\r\n\r\n");
    std::string told(12, '\0');  // "HTTP/1.1 200"
    EXPECT_EQ(::recv(socket.number(), told.data(), told.size(), MSG_WAITALL), 12);
    return std::stoi(told.substr(9));
  }

  ~EventServer() { feed_.end(); }

 private:
  EventFeed feed_{[] {
                    return std::vector<News>{{"status", "1"}};
                  },
                  {.poll_interval = 1ms, .heartbeat = 1ms}};
  HttpServer server_{{.address = "127.0.0.1", .port = 0}, [this](const Request& request) {
                       if (request.path != "/events") {
                         return Response{.body = "the page"};
                       }
                       auto stream = feed_.watch("");
                       return stream ? Response{.body = std::move(*stream)}
                                     : Response{.status = 503};
                     }};
};

TEST(EventServer, AnswersOthersBesideAllItsWatchers) {
  const EventServer server;
  std::vector<FileDescriptor> watchers;
  for (int i = 0; i < FeedLimits{}.max_watchers; ++i) {
    watchers.push_back(server.watch());
  }
  EXPECT_EQ(server.status_of_one_more(), 503);
  std::vector<FileDescriptor> slow;
  for (int i = 0; i < 200; ++i) {
    slow.push_back(connected(server.port()));
    send_text(slow.back(), "GET / HTTP/1.1\r\nHost: lo");
  }
  EXPECT_EQ(request(server.port(), "GET", "/").body, "the page");
  char byte = 0;
  for (const FileDescriptor& watcher : watchers) {
    EXPECT_EQ(::recv(watcher.number(), &byte, 1, 0), 1);  // these streams go on
  }
}

TEST(EventServer, GivesThePlaceOfWhoHasGoneToAnother) {
  const EventServer server;
  std::vector<FileDescriptor> watchers;
  for (int i = 0; i < FeedLimits{}.max_watchers; ++i) {
    watchers.push_back(server.watch());
  }
  watchers.pop_back();
  while (server.status_of_one_more() == 503) {  // CTest's timeout ends it otherwise
    std::this_thread::yield();
  }
}

}  // namespace
}  // namespace octurn
