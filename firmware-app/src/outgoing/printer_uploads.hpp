#pragma once

#include <filesystem>
#include <mutex>
#include <optional>
#include <stop_token>
#include <string>
#include <string_view>
#include <thread>

#include "outgoing/address_book.hpp"
#include "outgoing/http_client.hpp"

namespace octurn {

/// Readable reason why a printer has not accepted a model.
struct PrinterTrouble {
  std::string detail = {};
  std::string hint = {};
  std::string fingerprint = {};  ///< of a certificate that can be trusted; empty: none can
};

/// A file's name for a print server: without what it would take as a folder, or as hidden.
std::string printer_file_name(std::string name);

/// The request that uploads a file to a print server without printing it: OctoPrint's
/// `POST /api/files/local`, Moonraker's `POST /server/files/upload`, PrusaLink's
/// `PUT /api/v1/files/STORAGE/NAME`. An older file of that name is replaced.
/// @param storage  path of PrusaLink's storage, such as "/usb"; others ignore it
OutgoingRequest upload_request(const Printer& printer, const std::filesystem::path& file,
                               const std::string& name, const std::string& storage);

/// The path of the first writable storage in the body of that answer; nothing if there is none.
std::optional<std::string> usable_storage(const std::string& body);

/// The reason for which an answer refuses an upload; nothing if the printer has accepted it.
std::optional<PrinterTrouble> trouble_in(const Printer& printer, const OutgoingAnswer& answer);

/// An upload of a model to a printer.
struct PrinterUpload {
  enum class State { sending, sent, failed, cancelled };
  std::string scan = {};     ///< its id
  std::string printer = {};  ///< its name
  std::string file = {};     ///< its name on the printer
  State state = State::sending;
  double progress = 0;  ///< 0 to 1
  PrinterTrouble trouble = {};
};

std::string_view to_string(PrinterUpload::State state);

/// Uploads models to printers on its own thread, one at a time. Thread-safe.
class PrinterUploads {
 public:
  PrinterUploads() = default;
  PrinterUploads(const PrinterUploads&) = delete;
  PrinterUploads& operator=(const PrinterUploads&) = delete;

  /// Starts an upload.
  /// @param scan  id of the model's scan
  /// @param wanted_name  of the file on the printer, which gets `printer_file_name` of it, or, if
  ///                     it refuses letters that are not ASCII, a name by the scan's id
  /// @return nothing while another upload runs
  std::optional<PrinterUpload> start(const std::string& scan, const Printer& printer,
                                     const std::filesystem::path& file,
                                     const std::string& wanted_name);

  /// The last upload, if it is of that scan.
  std::optional<PrinterUpload> last(std::string_view scan) const;

  /// Asks that scan's upload to stop. @return false if it does not run
  bool cancel(std::string_view scan);

 private:
  void send(const Printer& printer, const std::filesystem::path& file, const std::string& name,
            const std::stop_token& stop);
  std::optional<PrinterTrouble> upload(const Printer& printer, const std::filesystem::path& file,
                                       const std::string& name, const std::stop_token& stop);

  std::mutex starting_ = {};       // guards worker_; locked before mutex_
  mutable std::mutex mutex_ = {};  // guards last_
  std::optional<PrinterUpload> last_ = {};
  std::jthread worker_;  // the last member, so that it ends before what it uses goes away
};

}  // namespace octurn
