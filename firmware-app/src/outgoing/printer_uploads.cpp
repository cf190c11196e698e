#include "outgoing/printer_uploads.hpp"

#include <algorithm>
#include <system_error>

#include "log.hpp"

namespace octurn {
namespace {

constexpr int bad_request = 400;

}  // namespace

std::string_view to_string(PrinterUpload::State state) {
  switch (state) {
    case PrinterUpload::State::sending:
      return "sending";
    case PrinterUpload::State::sent:
      return "sent";
    case PrinterUpload::State::failed:
      return "failed";
    case PrinterUpload::State::cancelled:
      break;
  }
  return "cancelled";
}

std::optional<PrinterUpload> PrinterUploads::start(const std::string& scan, const Printer& printer,
                                                   const std::filesystem::path& file,
                                                   const std::string& wanted_name) {
  const std::lock_guard starting(starting_);
  const std::string name = printer_file_name(wanted_name);
  PrinterUpload begun{.scan = scan, .printer = printer.name, .file = name};
  {
    const std::lock_guard lock(mutex_);
    if (last_ && last_->state == PrinterUpload::State::sending) {
      return std::nullopt;
    }
    last_ = begun;
  }
  // The previous worker has set its final state and is about to return: joining it does not block.
  worker_ = std::jthread([this, printer, file, name](const std::stop_token& stop) {
    send(printer, file, name, stop);
  });
  return begun;
}

std::optional<PrinterUpload> PrinterUploads::last(std::string_view scan) const {
  const std::lock_guard lock(mutex_);
  return last_ && last_->scan == scan ? last_ : std::nullopt;
}

bool PrinterUploads::cancel(std::string_view scan) {
  const std::lock_guard starting(starting_);  // keeps worker_ from being replaced
  const auto now = last(scan);
  if (!now || now->state != PrinterUpload::State::sending) {
    return false;
  }
  worker_.request_stop();
  return true;
}

/// @return nothing if the printer has accepted the file
std::optional<PrinterTrouble> PrinterUploads::upload(const Printer& printer,
                                                     const std::filesystem::path& file,
                                                     const std::string& name,
                                                     const std::stop_token& stop) {
  std::string storage;
  if (printer.kind == PrinterKind::prusalink) {
    const OutgoingAnswer answer = ask(storage_request(printer), stop);
    if (auto trouble = trouble_in(printer, answer)) {
      return trouble;
    }
    const auto usable = usable_storage(answer.body);
    if (!usable) {
      return PrinterTrouble{"PrusaLink has no storage that can be written to",
                            "Plug a USB stick into the printer."};
    }
    storage = *usable;
  }
  std::error_code gone;
  const auto bytes = static_cast<double>(std::filesystem::file_size(file, gone));
  const auto on_sent = [&](std::uint64_t sent) {
    const std::lock_guard lock(mutex_);
    last_->progress = gone ? 0 : std::min(1.0, static_cast<double>(sent) / std::max(bytes, 1.0));
  };
  OutgoingAnswer answer = ask(upload_request(printer, file, name, storage), stop, on_sent);
  const bool is_ascii =
      std::ranges::all_of(name, [](char c) { return static_cast<unsigned char>(c) < 0x80; });
  if (answer.status == bad_request && !is_ascii) {  // OctoPrint 1.11 takes no other names
    std::string plain_name;
    {
      const std::lock_guard lock(mutex_);
      plain_name = "Scan-" + last_->scan + std::filesystem::path(name).extension().string();
      last_->file = plain_name;
    }
    answer = ask(upload_request(printer, file, plain_name, storage), stop, on_sent);
  }
  return trouble_in(printer, answer);
}

void PrinterUploads::send(const Printer& printer, const std::filesystem::path& file,
                          const std::string& name, const std::stop_token& stop) {
  std::optional<PrinterTrouble> trouble;
  try {
    trouble = upload(printer, file, name, stop);
  } catch (const std::exception& error) {
    trouble = PrinterTrouble{error.what(), "Try again."};
  }
  if (trouble && !stop.stop_requested()) {
    log::warning("outgoing", "a printer has not taken a model: " + trouble->detail);
  }
  const std::lock_guard lock(mutex_);
  last_->state = !trouble                ? PrinterUpload::State::sent
                 : stop.stop_requested() ? PrinterUpload::State::cancelled
                                         : PrinterUpload::State::failed;
  if (last_->state == PrinterUpload::State::failed) {
    last_->trouble = *trouble;
  } else if (last_->state == PrinterUpload::State::sent) {
    last_->progress = 1;
  }
}

}  // namespace octurn
