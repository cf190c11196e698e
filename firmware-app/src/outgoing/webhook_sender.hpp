#pragma once

#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <deque>
#include <functional>
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

/// Something that webhooks are told of.
struct Happening {
  std::string event = {};  ///< one of webhook_events, or "test"
  std::string body = {};   ///< JSON
};

struct WebhookLimits {
  std::chrono::milliseconds look_interval{1000};
  std::chrono::milliseconds first_pause{5000};  ///< before it is tried again; then three times that
  int max_attempts = 6;
  std::size_t max_waiting = 64;  ///< of all webhooks; beyond that the oldest is given up
  std::chrono::milliseconds patience{10000};  ///< of one attempt
};

/// What became of the last thing that a webhook was told.
struct WebhookState {
  enum class Outcome { waiting, delivered, failed };
  Outcome outcome = Outcome::waiting;
  std::string event = {};
  std::string time = {};     ///< of the last attempt, RFC 3339; empty: there was none yet
  std::string trouble = {};  ///< why it was not delivered yet, or is given up
};

std::string_view to_string(WebhookState::Outcome outcome);

/// Tells the webhooks of an address book what happens, on a thread of its own: nobody waits for
/// them. What still waits when this ends is lost. Any thread may call it.
class WebhookSender {
 public:
  /// @param book  has to outlive this
  /// @param look  what has happened since it was called last
  WebhookSender(const AddressBook& book, std::function<std::vector<Happening>()> look,
                const WebhookLimits& limits = {});
  WebhookSender(const WebhookSender&) = delete;
  WebhookSender& operator=(const WebhookSender&) = delete;

  /// Tells one webhook something.
  void tell(const std::string& id, Happening happening);

  /// Nothing if it was told nothing yet.
  std::optional<WebhookState> state(std::string_view id) const;

 private:
  using Clock = std::chrono::steady_clock;
  struct Delivery {
    std::string webhook = {};  // its id
    Happening happening = {};
    int attempts = 0;
    Clock::time_point due = {};
  };

  void run(const std::stop_token& stop);
  void spread(const std::vector<Happening>& happenings);
  void add(Delivery delivery);
  std::optional<Delivery> take_due();
  void attempt(Delivery delivery, const std::stop_token& stop);
  void set_state(const Delivery& delivery, WebhookState::Outcome outcome, std::string trouble);

  const AddressBook& book_;
  const std::function<std::vector<Happening>()> look_;
  const WebhookLimits limits_;
  mutable std::mutex mutex_ = {};  // guards what follows
  std::condition_variable_any added_ = {};
  std::deque<Delivery> waiting_ = {};  // in the order in which they came
  std::map<std::string, WebhookState, std::less<>> states_ = {};
  std::jthread worker_;  // the last member, so that it ends before what it uses goes away
};

/// Why an answer to a webhook means that it was not taken; empty: it was.
std::string webhook_trouble(const OutgoingAnswer& answer);

/// Whether it may be taken if it is sent again later.
bool is_worth_another_attempt(const OutgoingAnswer& answer);

}  // namespace octurn
