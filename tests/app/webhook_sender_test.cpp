#include "outgoing/webhook_sender.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <cstdlib>
#include <future>
#include <thread>

#include "http/http_server.hpp"
#include "support/patience.hpp"
#include "support/temporary_folder.hpp"

namespace octurn {
namespace {

using namespace std::chrono_literals;

constexpr WebhookLimits brisk{
    .poll_interval = 1ms, .first_pause = 1ms, .max_attempts = 3, .patience = 1h};

/// A server that answers each request with the next of these statuses, and repeats the last one.
class Receiver {
 public:
  explicit Receiver(std::vector<int> answers) : answers_(std::move(answers)) {}

  std::string url() const {
    return "http://127.0.0.1:" + std::to_string(server_.port()) + "/hook?secret=1";
  }

  std::vector<Request> wait_for(std::size_t count) const {
    const auto deadline = std::chrono::steady_clock::now() + patience;
    while (std::chrono::steady_clock::now() < deadline) {
      if (std::vector<Request> now = received(); now.size() >= count) {
        return now;
      }
      std::this_thread::yield();
    }
    return received();
  }

  std::vector<Request> received() const {
    const std::lock_guard lock(mutex_);
    return received_;
  }

 private:
  Response take(const Request& request) {
    const std::lock_guard lock(mutex_);
    received_.push_back(request);
    const int status = answers_[std::min(received_.size(), answers_.size()) - 1];
    return {.status = status, .headers = {{"Location", "/elsewhere"}}};
  }

  mutable std::mutex mutex_ = {};  // guards received_
  std::vector<Request> received_ = {};
  std::vector<int> answers_;
  HttpServer server_{{.address = "127.0.0.1", .port = 0},
                     [this](const Request& request) { return take(request); }};
};

TEST(OutgoingRequest, GoesToItsAddressAndToNoProxy) {
  const Receiver proxy({200});
  const Receiver receiver({200});
  ::unsetenv("no_proxy");
  for (const char* const name : {"http_proxy", "all_proxy", "ALL_PROXY"}) {
    ::setenv(name, proxy.url().c_str(), 1);
  }
  EXPECT_EQ(ask({.url = receiver.url()}, {}).status, 200);
  for (const char* const name : {"http_proxy", "all_proxy", "ALL_PROXY"}) {
    ::unsetenv(name);
  }
  EXPECT_EQ(receiver.received().size(), 1U);
  EXPECT_TRUE(proxy.received().empty());
}

TEST(OutgoingRequest, KeepsTheFirst64KiBOfAnAnswer) {
  const HttpServer server({.address = "127.0.0.1", .port = 0},
                          [](const Request&) { return Response{.body = std::string(1e6, 'a')}; });
  const OutgoingAnswer answer =
      ask({.url = "http://127.0.0.1:" + std::to_string(server.port())}, {});
  EXPECT_EQ(answer.status, 200);
  EXPECT_EQ(answer.body.size(), 65536U);
}

TEST(OutgoingRequest, EndsAfterItsTimeAndWhereNothingMoves) {
  EXPECT_EQ(OutgoingRequest{}.time_limit, 10s);
  EXPECT_EQ(OutgoingRequest{}.still_limit, 30s);
  EXPECT_EQ(WebhookLimits{}.patience, 10s);
  std::promise<void> released;
  const std::shared_future<void> release = released.get_future().share();
  const HttpServer silent({.address = "127.0.0.1", .port = 0}, [&](const Request&) {
    release.wait();
    return Response{.status = 200};
  });
  const std::string url = "http://127.0.0.1:" + std::to_string(silent.port());
  const auto begin = std::chrono::steady_clock::now();
  EXPECT_NE(ask({.url = url, .time_limit = 500ms}, {}).trouble, "");
  EXPECT_NE(ask({.url = url, .time_limit = 1h, .still_limit = 1s}, {}).trouble, "");
  EXPECT_LT(std::chrono::steady_clock::now() - begin, patience);
  released.set_value();
}

TEST(WebhookSender, LetsNoWebhookWaitForASilentOne) {
  std::promise<void> released;
  const std::shared_future<void> release = released.get_future().share();
  const HttpServer silent({.address = "127.0.0.1", .port = 0}, [&](const Request&) {
    release.wait();
    return Response{.status = 200};
  });
  const Receiver quick({200});
  TemporaryFolder folder;
  AddressBook book(folder.path() / "addresses.json");
  const std::string first =
      book.add(Webhook{.url = "http://127.0.0.1:" + std::to_string(silent.port())}).id;
  const std::string second = book.add(Webhook{.url = quick.url()}).id;
  WebhookSender sender(
      book, [] { return std::vector<WebhookEvent>{}; }, brisk);
  sender.queue(first, {.name = "test", .body = "{}"});
  sender.queue(second, {.name = "test", .body = "{}"});
  EXPECT_EQ(quick.wait_for(1).size(), 1U);
  EXPECT_EQ(sender.state(first)->outcome, WebhookState::Outcome::waiting);
  released.set_value();
}

/// A sender with an address book that has one webhook.
class Sender {
 public:
  explicit Sender(const Receiver& receiver, std::vector<std::string> events = {},
                  const WebhookLimits& limits = brisk)
      : id_(book_.add(Webhook{.url = receiver.url(), .events = std::move(events)}).id),
        sender_(
            book_, [this] { return std::exchange(happened_, {}); }, limits) {}

  void queue(const std::string& event, const std::string& body = "{}") {
    sender_.queue(id_, {.name = event, .body = body});
  }

  WebhookState wait_for(WebhookState::Outcome outcome) const {
    const auto deadline = std::chrono::steady_clock::now() + patience;
    std::optional<WebhookState> state = sender_.state(id_);
    while ((!state || state->outcome != outcome) && std::chrono::steady_clock::now() < deadline) {
      std::this_thread::yield();
      state = sender_.state(id_);
    }
    return state.value_or(WebhookState{});
  }

  /// Removes the webhook. @return whether the sender forgets its state
  bool forgets() {
    book_.remove_webhook(id_);
    const auto deadline = std::chrono::steady_clock::now() + patience;
    while (sender_.state(id_) && std::chrono::steady_clock::now() < deadline) {
      std::this_thread::yield();
    }
    return !sender_.state(id_);
  }

 protected:
  TemporaryFolder folder_ = {};
  AddressBook book_{folder_.path() / "addresses.json"};
  std::vector<WebhookEvent> happened_ = {};
  std::string id_;
  WebhookSender sender_;
};

TEST(WebhookSender, TellsWhatHappenedAsJson) {
  const Receiver receiver({200});
  Sender sender(receiver);
  sender.queue("scan-finished", R"({"event":"scan-finished"})");
  const std::vector<Request> received = receiver.wait_for(1);
  ASSERT_EQ(received.size(), 1U);
  EXPECT_EQ(received[0].method, "POST");
  EXPECT_EQ(received[0].path, "/hook");
  EXPECT_EQ(received[0].header("Content-Type"), "application/json");
  EXPECT_EQ(received[0].body, R"({"event":"scan-finished"})");
  EXPECT_EQ(sender.wait_for(WebhookState::Outcome::delivered).trouble, "");
}

TEST(WebhookSender, TriesAgainWhatWasNotTaken) {
  const Receiver receiver({500, 503, 204});
  Sender sender(receiver);
  sender.queue("warning");
  EXPECT_EQ(sender.wait_for(WebhookState::Outcome::delivered).event, "warning");
  EXPECT_EQ(receiver.received().size(), 3U);
}

TEST(WebhookSender, GivesUpInTheEnd) {
  const Receiver receiver({500});
  Sender sender(receiver);
  sender.queue("warning");
  EXPECT_EQ(sender.wait_for(WebhookState::Outcome::failed).trouble, "it answered 500");
  EXPECT_EQ(receiver.received().size(), 3U);
}

TEST(WebhookSender, DoesNotInsistWhereItIsRefused) {
  const Receiver receiver({410});
  Sender sender(receiver);
  sender.queue("warning");
  EXPECT_EQ(sender.wait_for(WebhookState::Outcome::failed).trouble, "it answered 410");
  EXPECT_EQ(receiver.received().size(), 1U);
}

TEST(WebhookSender, FollowsNoRedirect) {
  const Receiver receiver({307});
  Sender sender(receiver);
  sender.queue("warning");
  EXPECT_NE(sender.wait_for(WebhookState::Outcome::failed).trouble.find("redirect"),
            std::string::npos);
  EXPECT_EQ(receiver.received().size(), 1U);
}

TEST(WebhookSender, SaysThatNobodyAnswers) {
  std::string url;
  {
    const Receiver gone({200});
    url = gone.url();
  }
  const TemporaryFolder folder;
  AddressBook book(folder.path() / "addresses.json");
  const std::string id = book.add(Webhook{.url = url}).id;
  WebhookSender sender(
      book, [] { return std::vector<WebhookEvent>{}; }, brisk);
  sender.queue(id, {.name = "test", .body = "{}"});
  std::optional<WebhookState> state = sender.state(id);
  const auto deadline = std::chrono::steady_clock::now() + patience;
  while (state->outcome != WebhookState::Outcome::failed &&
         std::chrono::steady_clock::now() < deadline) {
    std::this_thread::yield();
    state = sender.state(id);
  }
  EXPECT_EQ(state->outcome, WebhookState::Outcome::failed);
  EXPECT_NE(state->trouble, "");
}

TEST(WebhookSender, GivesUpWhatIsOldestWhereTooMuchWaits) {
  const Receiver receiver({500});
  WebhookLimits limits = brisk;
  limits.first_pause = 1h;
  limits.max_waiting = 2;
  Sender sender(receiver, {}, limits);
  sender.queue("scan-started");
  receiver.wait_for(1);
  for (const char* event : {"scan-paused", "scan-failed", "warning"}) {
    sender.queue(event);
  }
  EXPECT_EQ(sender.wait_for(WebhookState::Outcome::failed).trouble,
            "dropped, because too many events were waiting");
}

TEST(WebhookSender, ForgetsAWebhookThatWasRemoved) {
  const Receiver receiver({200});
  Sender sender(receiver);
  sender.queue("warning");
  sender.wait_for(WebhookState::Outcome::delivered);
  EXPECT_TRUE(sender.forgets());
}

/// A sender whose source of news returns something once.
class News : public Sender {
 public:
  News(const Receiver& receiver, std::vector<std::string> events)
      : Sender(receiver, std::move(events)),
        other_(
            book_, [this] { return std::exchange(news_, {}); }, brisk) {}

 private:
  std::vector<WebhookEvent> news_{{.name = "scan-started", .body = "1"},
                                  {.name = "scan-finished", .body = "2"}};
  WebhookSender other_;
};

TEST(WebhookSender, TellsEachOneWhatItWants) {
  const Receiver picky({200});
  const Receiver curious({200});
  const News one(picky, {"scan-finished"});
  const News other(curious, {});
  EXPECT_EQ(curious.wait_for(2).size(), 2U);
  ASSERT_EQ(picky.wait_for(1).size(), 1U);
  EXPECT_EQ(picky.received()[0].body, "2");
}

TEST(WebhookSender, EndsAtOnceWhileAReceiverIsSlow) {
  std::promise<void> asked;
  std::promise<void> answered;
  auto release = answered.get_future().share();
  const HttpServer slow({.address = "127.0.0.1", .port = 0}, [&](const Request&) {
    asked.set_value();
    release.wait();
    return Response{};
  });
  const TemporaryFolder folder;
  AddressBook book(folder.path() / "addresses.json");
  const std::string url = "http://127.0.0.1:" + std::to_string(slow.port()) + "/";
  const std::string id = book.add(Webhook{.url = url}).id;
  {
    WebhookSender sender(
        book, [] { return std::vector<WebhookEvent>{}; }, brisk);
    sender.queue(id, {.name = "test", .body = "{}"});
    asked.get_future().wait();
  }  // the destructor returns here, or CTest's timeout ends the test
  answered.set_value();
}

}  // namespace
}  // namespace octurn
