#pragma once

#include <cstddef>
#include <filesystem>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "octurn/json_object.hpp"

namespace octurn {

/// A web address that receives events by POST.
struct Webhook {
  std::string id = {};
  std::string url = {};                  ///< may contain a secret: never sent to clients
  std::vector<std::string> events = {};  ///< that it receives; empty: all
};

/// The events that a webhook can receive.
extern const std::vector<std::string_view> webhook_events;

enum class PrinterKind { octoprint, moonraker, prusalink };

std::string_view to_string(PrinterKind kind);

/// A print server that receives models.
struct Printer {
  std::string id = {};
  std::string name = {};  ///< display name, unique
  PrinterKind kind = PrinterKind::octoprint;
  std::string url = {};   ///< base address of its API
  std::string user = {};  ///< of PrusaLink, for HTTP Digest; empty: the key is sent in a header
  std::string key = {};   ///< API key, or the user's password; never sent to clients
  /// Trusted one, as `OutgoingRequest::fingerprint`; empty: an authority has to sign.
  std::string fingerprint = {};
};

/// Reads a webhook, or a printer, without its id.
/// @throws Error "bad-settings"  that names the key, its value and what is allowed
Webhook webhook_from(JsonObject& object);
Printer printer_from(JsonObject& object);

/// Reads the fingerprint of a printer's certificate; empty if the key is missing.
/// @throws Error "bad-settings"
std::string fingerprint_from(JsonObject& object);

/// The webhooks and printers that users have added, stored in a file that only its owner can read.
/// Thread-safe.
class AddressBook {
 public:
  static constexpr std::size_t max_of_each = 16;

  /// @param file  read if it exists; a malformed file counts as empty
  explicit AddressBook(std::filesystem::path file);

  std::vector<Webhook> webhooks() const;
  std::vector<Printer> printers() const;

  /// The webhook of that id, if there is one.
  std::optional<Webhook> find_webhook(std::string_view id) const;
  /// The printer of that id or name, if there is one.
  std::optional<Printer> find_printer(std::string_view id_or_name) const;

  /// Adds a webhook or a printer under a new id.
  /// @throws Error "bad-settings" if there are max_of_each, or a printer of that name;
  ///               "disk-full", "write-failed"
  Webhook add(Webhook webhook);
  Printer add(Printer printer);

  /// Trusts a certificate of a printer. @return the printer; nothing if there is none of that id
  /// @throws Error "disk-full", "write-failed"
  std::optional<Printer> trust(std::string_view id, const std::string& fingerprint);

  /// Removes a webhook or a printer. @return false if there is none of that id
  /// @throws Error "disk-full", "write-failed"
  bool remove_webhook(std::string_view id);
  bool remove_printer(std::string_view id);

 private:
  struct Entries {
    std::vector<Webhook> webhooks = {};
    std::vector<Printer> printers = {};
  };

  static Entries read(const std::filesystem::path& file);
  void store(Entries entries);

  const std::filesystem::path file_;
  mutable std::mutex mutex_ = {};  // guards entries_, and the file
  Entries entries_ = {};
};

}  // namespace octurn
