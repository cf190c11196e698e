#pragma once

#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <deque>
#include <functional>
#include <future>
#include <map>
#include <mutex>
#include <optional>
#include <stop_token>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "outgoing/address_book.hpp"
#include "outgoing/http_client.hpp"

namespace octurn {

/// An event as it is sent to webhooks.
struct WebhookEvent {
  std::string name = {};  ///< one of webhook_events, or "test"
  std::string body = {};  ///< JSON
};

struct WebhookLimits {
  std::chrono::milliseconds poll_interval{1000};
  std::chrono::milliseconds first_pause{5000};  ///< before the first retry; then tripled each time
  int max_attempts = 6;
  std::size_t max_waiting = 64;  ///< deliveries of all webhooks; beyond it the oldest is dropped
  std::chrono::milliseconds patience{10000};  ///< time limit of an attempt
};

/// State of the last delivery to a webhook.
struct WebhookState {
  enum class Outcome { waiting, delivered, failed };
  Outcome outcome = Outcome::waiting;
  std::string event = {};
  std::string time = {};     ///< of the last attempt, RFC 3339; empty: there was none yet
  std::string trouble = {};  ///< why it is not delivered yet, or was given up
};

std::string_view to_string(WebhookState::Outcome outcome);

/// Delivers events to the webhooks of an address book on threads of its own, so that no caller
/// waits, nor any webhook for another one that is silent. Each gets its events one after the other.
/// Deliveries that still wait at its destruction are lost. Thread-safe.
class WebhookSender {
 public:
  /// @param book  has to outlive this
  /// @param poll  returns the events since its last call; called on the sender's thread
  WebhookSender(const AddressBook& book, std::function<std::vector<WebhookEvent>()> poll,
                const WebhookLimits& limits = {});
  WebhookSender(const WebhookSender&) = delete;
  WebhookSender& operator=(const WebhookSender&) = delete;

  /// Queues an event for one webhook.
  void queue(const std::string& id, WebhookEvent event);

  /// The state of a webhook's last delivery; nothing if there was none yet.
  std::optional<WebhookState> state(std::string_view id) const;

 private:
  using Clock = std::chrono::steady_clock;
  struct Delivery {
    std::string webhook = {};  // its id
    WebhookEvent event = {};
    int attempts = 0;
    Clock::time_point due = {};
  };

  void run(const std::stop_token& stop);
  void spread(const std::vector<WebhookEvent>& events);
  void add(Delivery delivery);
  void forget_removed();
  using UnderWay = std::map<std::string, std::future<void>, std::less<>>;  // by a webhook's id

  bool is_due(const Delivery& delivery, const UnderWay& under_way) const;
  std::optional<Delivery> take_due(const UnderWay& under_way);
  void attempt(Delivery delivery, const std::stop_token& stop);
  void set_state(const Delivery& delivery, WebhookState::Outcome outcome, std::string trouble);

  const AddressBook& book_;
  const std::function<std::vector<WebhookEvent>()> poll_;
  const WebhookLimits limits_;
  mutable std::mutex mutex_ = {};  // guards what follows
  std::condition_variable_any added_ = {};
  std::deque<Delivery> waiting_ = {};  // in the order in which they were queued
  std::map<std::string, WebhookState, std::less<>> states_ = {};
  std::jthread worker_;  // the last member, so that it ends before what it uses goes away
};

/// Whether a failed delivery with that answer may succeed later.
bool is_worth_another_attempt(const OutgoingAnswer& answer);

}  // namespace octurn
