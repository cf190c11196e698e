#include "outgoing/webhook_sender.hpp"

#include <algorithm>
#include <utility>

#include "log.hpp"
#include "wall_clock.hpp"

namespace octurn {
namespace {

constexpr int pause_growth = 3;

bool wants(const Webhook& webhook, const std::string& event) {
  return webhook.events.empty() || std::ranges::count(webhook.events, event) > 0;
}

}  // namespace

std::string_view to_string(WebhookState::Outcome outcome) {
  switch (outcome) {
    case WebhookState::Outcome::waiting:
      return "waiting";
    case WebhookState::Outcome::delivered:
      return "delivered";
    case WebhookState::Outcome::failed:
      break;
  }
  return "failed";
}

namespace {

/// The reason why a delivery with that answer has failed; empty if it has succeeded.
std::string webhook_trouble(const OutgoingAnswer& answer) {
  if (answer.status == 0) {
    return answer.trouble;
  }
  if (answer.status >= 300 && answer.status < 400) {
    return "it answered " + std::to_string(answer.status) +
           ", a redirect, which is not followed: give the address that it leads to";
  }
  return answer.status < 300 ? "" : "it answered " + std::to_string(answer.status);
}

}  // namespace

// No answer, a timeout (408), too early (425, RFC 8470), too many requests (429, RFC 6585) or a
// server error (RFC 9110, section 15.6).
bool is_worth_another_attempt(const OutgoingAnswer& answer) {
  return answer.status == 0 || answer.status == 408 || answer.status == 425 ||
         answer.status == 429 || answer.status >= 500;
}

WebhookSender::WebhookSender(const AddressBook& book,
                             std::function<std::vector<WebhookEvent>()> poll,
                             const WebhookLimits& limits)
    : book_(book),
      poll_(std::move(poll)),
      limits_(limits),
      worker_([this](const std::stop_token& stop) { run(stop); }) {}

void WebhookSender::queue(const std::string& id, WebhookEvent event) {
  add({.webhook = id, .event = std::move(event), .due = Clock::now()});
}

std::optional<WebhookState> WebhookSender::state(std::string_view id) const {
  const std::lock_guard lock(mutex_);
  const auto found = states_.find(id);
  return found == states_.end() ? std::nullopt : std::optional(found->second);
}

void WebhookSender::run(const std::stop_token& stop) {
  UnderWay under_way;
  while (!stop.stop_requested()) {
    try {
      std::erase_if(under_way, [](const auto& one) {
        return one.second.wait_for(std::chrono::seconds(0)) == std::future_status::ready;
      });
      forget_removed();
      spread(poll_());
      if (auto due = take_due(under_way)) {
        const std::string webhook = due->webhook;
        under_way[webhook] = std::async(std::launch::async, [this, stop, taken = *std::move(due)] {
          attempt(taken, stop);
          added_.notify_all();
        });
        continue;
      }
    } catch (const std::exception& error) {
      log::error("outgoing", std::string("cannot send events to the webhooks: ") + error.what());
    }
    std::unique_lock lock(mutex_);
    added_.wait_for(lock, stop, limits_.poll_interval, [&] {
      return std::ranges::any_of(waiting_,
                                 [&](const Delivery& one) { return is_due(one, under_way); });
    });
  }
}

void WebhookSender::spread(const std::vector<WebhookEvent>& events) {
  if (events.empty()) {
    return;
  }
  for (const Webhook& webhook : book_.webhooks()) {
    for (const WebhookEvent& event : events) {
      if (wants(webhook, event.name)) {
        queue(webhook.id, event);
      }
    }
  }
}

void WebhookSender::add(Delivery delivery) {
  std::optional<Delivery> given_up;
  {
    const std::lock_guard lock(mutex_);
    if (waiting_.size() >= limits_.max_waiting) {
      given_up = std::move(waiting_.front());
      waiting_.pop_front();
    }
    if (delivery.attempts == 0) {
      states_[delivery.webhook] = {.event = delivery.event.name};
    }
    waiting_.push_back(std::move(delivery));
  }
  added_.notify_all();
  if (given_up) {
    set_state(*given_up, WebhookState::Outcome::failed,
              "dropped, because too many events were waiting");
  }
}

/// Drops the states and deliveries of webhooks that the address book no longer has.
void WebhookSender::forget_removed() {
  // The book is read under the lock: what is queued for a webhook that is added later stays.
  const std::lock_guard lock(mutex_);
  const std::vector<Webhook> webhooks = book_.webhooks();
  const auto is_removed = [&](const std::string& id) {
    return std::ranges::find(webhooks, id, &Webhook::id) == webhooks.end();
  };
  std::erase_if(states_, [&](const auto& state) { return is_removed(state.first); });
  std::erase_if(waiting_, [&](const Delivery& delivery) { return is_removed(delivery.webhook); });
}

/// Whether the time of a delivery has come, and no other one to its webhook is under way.
bool WebhookSender::is_due(const Delivery& delivery, const UnderWay& under_way) const {
  return delivery.due <= Clock::now() && !under_way.contains(delivery.webhook);
}

std::optional<WebhookSender::Delivery> WebhookSender::take_due(const UnderWay& under_way) {
  const std::lock_guard lock(mutex_);
  const auto due =
      std::ranges::find_if(waiting_, [&](const Delivery& one) { return is_due(one, under_way); });
  if (due == waiting_.end()) {
    return std::nullopt;
  }
  Delivery taken = std::move(*due);
  waiting_.erase(due);
  return taken;
}

void WebhookSender::attempt(Delivery delivery, const std::stop_token& stop) {
  const auto webhook = book_.find_webhook(delivery.webhook);
  if (!webhook) {
    return;  // removed meanwhile
  }
  const OutgoingAnswer answer = ask({.method = "POST",
                                     .url = webhook->url,
                                     .headers = {"Content-Type: application/json"},
                                     .body = delivery.event.body,
                                     .time_limit = limits_.patience},
                                    stop);
  const std::string trouble = webhook_trouble(answer);
  ++delivery.attempts;
  if (trouble.empty()) {
    set_state(delivery, WebhookState::Outcome::delivered, "");
  } else if (!is_worth_another_attempt(answer) || delivery.attempts >= limits_.max_attempts) {
    set_state(delivery, WebhookState::Outcome::failed, trouble);
    log::warning("outgoing",
                 "a webhook of " + to_origin(webhook->url) + " is given up: " + trouble);
  } else {
    set_state(delivery, WebhookState::Outcome::waiting, trouble);
    std::chrono::milliseconds pause = limits_.first_pause;
    for (int i = 1; i < delivery.attempts; ++i) {
      pause *= pause_growth;
    }
    delivery.due = Clock::now() + pause;
    add(std::move(delivery));
  }
}

void WebhookSender::set_state(const Delivery& delivery, WebhookState::Outcome outcome,
                              std::string trouble) {
  const std::lock_guard lock(mutex_);
  states_[delivery.webhook] = {.outcome = outcome,
                               .event = delivery.event.name,
                               .time = utc_text(std::chrono::system_clock::now(), rfc3339),
                               .trouble = std::move(trouble)};
}

}  // namespace octurn
