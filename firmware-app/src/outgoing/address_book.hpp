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

/// An address that is told what happens.
struct Webhook {
  std::string id = {};
  std::string url = {};                  ///< may hold a secret: never told again
  std::vector<std::string> events = {};  ///< that it is told; empty: all
};

/// What a webhook can be told.
extern const std::vector<std::string_view> webhook_events;

enum class PrinterKind { octoprint, moonraker, prusalink };

std::string_view to_string(PrinterKind kind);

/// A print server that takes models.
struct Printer {
  std::string id = {};
  std::string name = {};  ///< for people, and no other's
  PrinterKind kind = PrinterKind::octoprint;
  std::string url = {};   ///< that the paths of its interface are appended to
  std::string user = {};  ///< of PrusaLink, for HTTP Digest; empty: the key is sent as it is
  std::string key = {};   ///< or the password; never told again
};

/// A webhook, or a printer, as a person describes it.
/// @throws Error "bad-settings"  that names the key, its value and what is allowed
Webhook webhook_from(JsonObject& object);
Printer printer_from(JsonObject& object);

/// Whom this machine tells something, and sends models to, because somebody has set it so. Kept in
/// a file that only its owner can read. Any thread may call it.
class AddressBook {
 public:
  static constexpr std::size_t max_of_each = 16;

  /// @param file  of an earlier run, if there is one; of one that is malformed nothing counts
  explicit AddressBook(std::filesystem::path file);

  std::vector<Webhook> webhooks() const;
  std::vector<Printer> printers() const;

  /// The one of that id, if there is one.
  std::optional<Webhook> find_webhook(std::string_view id) const;
  /// The one of that id or name, if there is one.
  std::optional<Printer> find_printer(std::string_view id_or_name) const;

  /// Adds one, under a new id.
  /// @throws Error "bad-settings" if there are max_of_each, or a printer of that name;
  ///               "disk-full", "write-failed"
  Webhook add(Webhook webhook);
  Printer add(Printer printer);

  /// @return false if there is none @throws Error "disk-full", "write-failed"
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
