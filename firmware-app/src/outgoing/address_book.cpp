#include "outgoing/address_book.hpp"

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>
#include <utility>

#include "log.hpp"
#include "octurn/error.hpp"
#include "octurn/file.hpp"
#include "one_line.hpp"
#include "outgoing/http_client.hpp"
#include "random_digits.hpp"

namespace octurn {
namespace {

using nlohmann::json;

constexpr std::size_t max_file_bytes = std::size_t{256} << 10U;
constexpr std::size_t max_text = 500;  // bytes
constexpr std::size_t id_bytes = 4;
constexpr std::array kinds{PrinterKind::octoprint, PrinterKind::moonraker, PrinterKind::prusalink};

/// Reads one line of at most 500 bytes; empty if the key is missing.
std::string short_text(JsonObject& object, std::string_view key) {
  const auto value = object.value(key);
  if (!value) {
    return "";
  }
  std::string text = value->text();
  if (text.size() > max_text || !is_one_line(text)) {
    value->refuse("one line of at most 500 bytes");
  }
  return text;
}

std::string web_address(JsonObject& object) {
  const JsonValue given = object.at("url");
  std::string url = short_text(object, "url");
  if (to_origin(url).empty()) {
    given.refuse("a web address, http://HOST/PATH, without a user and a password");
  }
  return url;
}

json to_json(const Webhook& webhook) {
  return {{"id", webhook.id}, {"url", webhook.url}, {"events", webhook.events}};
}

json to_json(const Printer& printer) {
  json body{{"id", printer.id},   {"name", printer.name}, {"kind", to_string(printer.kind)},
            {"url", printer.url}, {"user", printer.user}, {"key", printer.key}};
  if (!printer.fingerprint.empty()) {  // older versions refuse a file with this key
    body["fingerprint"] = printer.fingerprint;
  }
  return body;
}

template <typename Entry>
json to_array(const std::vector<Entry>& entries) {
  json all = json::array();
  for (const Entry& entry : entries) {
    all.push_back(to_json(entry));
  }
  return all;
}

/// Reads the entries of an array, each with its id.
template <typename Entry>
std::vector<Entry> entries_in(const JsonValue& array, Entry (*read)(JsonObject&)) {
  std::vector<Entry> entries;
  for (const JsonValue& value : array.elements()) {
    JsonObject object(value);
    Entry entry = read(object);
    entry.id = object.at("id").text();
    object.refuse_unread();
    entries.push_back(std::move(entry));
  }
  return entries;
}

template <typename Entry>
void expect_room(const std::vector<Entry>& entries, const char* what) {
  if (entries.size() >= AddressBook::max_of_each) {
    throw Error(ErrorCode::bad_settings,
                "there are " + std::to_string(entries.size()) + " " + what + " already",
                "Remove one that is no longer used.");
  }
}

}  // namespace

const std::vector<std::string_view> webhook_events{
    "scan-started", "scan-paused", "scan-finished", "scan-failed", "scan-cancelled", "warning"};

std::string_view to_string(PrinterKind kind) {
  switch (kind) {
    case PrinterKind::octoprint:
      return "octoprint";
    case PrinterKind::moonraker:
      return "moonraker";
    case PrinterKind::prusalink:
      break;
  }
  return "prusalink";
}

Webhook webhook_from(JsonObject& object) {
  Webhook webhook{.url = web_address(object)};
  if (const auto events = object.value("events")) {
    for (const JsonValue& event : events->elements()) {
      if (std::ranges::find(webhook_events, event.text()) == webhook_events.end()) {
        event.refuse(
            "scan-started, scan-paused, scan-finished, scan-failed, scan-cancelled or warning");
      }
      webhook.events.push_back(event.text());
    }
  }
  return webhook;
}

Printer printer_from(JsonObject& object) {
  Printer printer{.name = short_text(object, "name")};
  if (printer.name.empty()) {
    object.at("name").refuse("what the printer is called");
  }
  const JsonValue kind = object.at("kind");
  const auto* const known = std::ranges::find(
      kinds, kind.text(), [](PrinterKind one) { return std::string(to_string(one)); });
  if (known == kinds.end()) {
    kind.refuse("octoprint, moonraker or prusalink");
  }
  printer.kind = *known;
  printer.url = web_address(object);
  if (printer.url.find('?') != std::string::npos) {
    object.at("url").refuse("an address without a question mark");
  }
  while (printer.url.ends_with('/')) {
    printer.url.pop_back();
  }
  printer.user = short_text(object, "user");
  printer.key = short_text(object, "key");
  printer.fingerprint = fingerprint_from(object);
  return printer;
}

std::string fingerprint_from(JsonObject& object) {
  constexpr std::string_view start = "sha256//";
  constexpr std::size_t letters = 43;  // of 32 bytes in Base64, before the "="
  constexpr std::string_view base64 =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  const std::string text = short_text(object, "fingerprint");
  if (!text.empty() && (!text.starts_with(start) || !text.ends_with('=') ||
                        text.find_first_not_of(base64, start.size()) != start.size() + letters ||
                        text.size() != start.size() + letters + 1)) {
    object.at("fingerprint").refuse("sha256// and 44 letters of Base64");
  }
  return text;
}

AddressBook::AddressBook(std::filesystem::path file)
    : file_(std::move(file)), entries_(read(file_)) {}

AddressBook::Entries AddressBook::read(const std::filesystem::path& file) try {
  Entries entries;
  if (const auto text = read_regular_file(file, max_file_bytes)) {
    const json document = parse_json(*text, ErrorCode::bad_settings, "it");
    JsonObject object(document, ErrorCode::bad_settings, "");
    entries.webhooks = entries_in(object.at("webhooks"), webhook_from);
    entries.printers = entries_in(object.at("printers"), printer_from);
  }
  return entries;
} catch (const Error& error) {
  log::warning("outgoing", file.string() + " is malformed; its webhooks and printers are ignored");
  return {};
}

/// Writes the file, and then puts the entries into force.
void AddressBook::store(Entries entries) {
  const json document{{"webhooks", to_array(entries.webhooks)},
                      {"printers", to_array(entries.printers)}};
  write_file(file_, document.dump(2) + "\n", 0600);
  entries_ = std::move(entries);
}

std::vector<Webhook> AddressBook::webhooks() const {
  const std::lock_guard lock(mutex_);
  return entries_.webhooks;
}

std::vector<Printer> AddressBook::printers() const {
  const std::lock_guard lock(mutex_);
  return entries_.printers;
}

std::optional<Webhook> AddressBook::find_webhook(std::string_view id) const {
  const std::lock_guard lock(mutex_);
  const auto found = std::ranges::find(entries_.webhooks, id, &Webhook::id);
  return found == entries_.webhooks.end() ? std::nullopt : std::optional(*found);
}

std::optional<Printer> AddressBook::find_printer(std::string_view id_or_name) const {
  const std::lock_guard lock(mutex_);
  const auto found = std::ranges::find_if(entries_.printers, [&](const Printer& printer) {
    return printer.id == id_or_name || printer.name == id_or_name;
  });
  return found == entries_.printers.end() ? std::nullopt : std::optional(*found);
}

Webhook AddressBook::add(Webhook webhook) {
  const std::lock_guard lock(mutex_);
  expect_room(entries_.webhooks, "webhooks");
  webhook.id = random_digits(id_bytes);
  Entries next = entries_;
  next.webhooks.push_back(webhook);
  store(std::move(next));
  return webhook;
}

Printer AddressBook::add(Printer printer) {
  const std::lock_guard lock(mutex_);
  expect_room(entries_.printers, "printers");
  if (std::ranges::count(entries_.printers, printer.name, &Printer::name) > 0) {
    throw Error(ErrorCode::bad_settings, "there is a printer \"" + printer.name + "\" already",
                "Remove it first, or choose another name.");
  }
  printer.id = random_digits(id_bytes);
  Entries next = entries_;
  next.printers.push_back(printer);
  store(std::move(next));
  return printer;
}

std::optional<Printer> AddressBook::trust(std::string_view id, const std::string& fingerprint) {
  const std::lock_guard lock(mutex_);
  Entries next = entries_;
  const auto found = std::ranges::find(next.printers, id, &Printer::id);
  if (found == next.printers.end()) {
    return std::nullopt;
  }
  found->fingerprint = fingerprint;
  Printer trusted = *found;
  store(std::move(next));
  return trusted;
}

bool AddressBook::remove_webhook(std::string_view id) {
  const std::lock_guard lock(mutex_);
  Entries next = entries_;
  if (std::erase_if(next.webhooks, [&](const Webhook& one) { return one.id == id; }) == 0) {
    return false;
  }
  store(std::move(next));
  return true;
}

bool AddressBook::remove_printer(std::string_view id) {
  const std::lock_guard lock(mutex_);
  Entries next = entries_;
  if (std::erase_if(next.printers, [&](const Printer& one) { return one.id == id; }) == 0) {
    return false;
  }
  store(std::move(next));
  return true;
}

}  // namespace octurn
