#pragma once

#include <filesystem>
#include <mutex>
#include <optional>
#include <stop_token>
#include <string>
#include <string_view>
#include <thread>

#include "outgoing/address_book.hpp"
#include "outgoing/print_server.hpp"

namespace octurn {

/// A model on its way to a printer.
struct PrinterUpload {
  enum class State { sending, sent, failed, cancelled };
  std::string scan = {};     ///< its id
  std::string printer = {};  ///< its name
  std::string file = {};     ///< as it is called there
  State state = State::sending;
  double progress = 0;  ///< 0 to 1
  PrinterTrouble trouble = {};
};

std::string_view to_string(PrinterUpload::State state);

/// Sends models to printers, one at a time, on a thread of its own. Any thread may call it.
class PrinterUploads {
 public:
  PrinterUploads() = default;
  PrinterUploads(const PrinterUploads&) = delete;
  PrinterUploads& operator=(const PrinterUploads&) = delete;

  /// Begins to send a file.
  /// @param name  that it has there
  /// @return nothing while another one is sent
  std::optional<PrinterUpload> start(const std::string& scan, const Printer& printer,
                                     const std::filesystem::path& file, const std::string& name);

  /// The last upload, if it is of that scan.
  std::optional<PrinterUpload> last(std::string_view scan) const;

  /// Asks that scan's upload to stop. @return false if none goes on
  bool cancel(std::string_view scan);

 private:
  void send(const Printer& printer, const std::filesystem::path& file, const std::string& name,
            const std::stop_token& stop);
  std::optional<PrinterTrouble> upload(const Printer& printer, const std::filesystem::path& file,
                                       const std::string& name, const std::stop_token& stop);

  std::mutex starting_ = {};       // held by who starts an upload; taken before mutex_
  mutable std::mutex mutex_ = {};  // guards last_
  std::optional<PrinterUpload> last_ = {};
  std::jthread worker_;  // the last member, so that it ends before what it uses goes away
};

}  // namespace octurn
