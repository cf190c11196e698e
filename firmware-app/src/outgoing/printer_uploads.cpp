#include "outgoing/printer_uploads.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <system_error>

#include "log.hpp"
#include "one_line.hpp"

namespace octurn {
namespace {

using nlohmann::json;

/// Long, as slow uploads are fine: the HTTP client gives up those that stall.
constexpr std::chrono::hours upload_limit{1};

OutgoingRequest authorized(const Printer& printer, std::string method, const std::string& path) {
  OutgoingRequest request{
      .method = std::move(method), .url = printer.url + path, .fingerprint = printer.fingerprint};
  if (!printer.user.empty()) {
    request.user = printer.user;
    request.password = printer.key;
  } else if (!printer.key.empty()) {
    request.headers.push_back("X-Api-Key: " + printer.key);
  }
  return request;
}

std::string program_name(PrinterKind kind) {
  switch (kind) {
    case PrinterKind::octoprint:
      return "OctoPrint";
    case PrinterKind::moonraker:
      return "Moonraker";
    case PrinterKind::prusalink:
      break;
  }
  return "PrusaLink";
}

/// Advice for a print server that does not accept models.
std::string slicing_hint(PrinterKind kind) {
  std::string hint = program_name(kind);
  hint += kind == PrinterKind::octoprint ? " takes STL where a plug-in slices it."
                                         : " takes what is sliced already.";
  hint += " Download the model, slice it, and upload the G-code.";
  return hint;
}

/// The text of an error in JSON, as print servers write it; nothing if it has none.
std::optional<std::string> json_reason(const std::string& body) try {
  json answer = parse_json(body, ErrorCode::bad_json, "it");
  for (const char* const key : {"error", "message", "detail", "title"}) {
    if (answer.is_object() && answer.contains(key)) {
      answer = json(answer[key]);
    }
  }
  return answer.is_string() ? answer.get<std::string>() : std::string();
} catch (const Error&) {
  return std::nullopt;
}

/// The first line of the reason in an answer's body; empty if it has none, such as a page of HTML.
std::string reason_in(const std::string& body) {
  constexpr std::size_t longest = 200;
  std::optional<std::string> reason = json_reason(body);
  const bool is_json = reason.has_value();
  const auto is_ascii = [](char c) { return c >= ' ' && c <= '~'; };
  if (!reason) {
    reason = body;
  }
  reason->resize(std::min(reason->size(), reason->find_first_of("\r\n")));
  if (!is_json && (!std::ranges::all_of(*reason, is_ascii) || reason->find('<') != reason->npos)) {
    return "";
  }
  std::size_t length = std::min(longest, reason->size());
  while (length > 0 && length < reason->size() && ((*reason)[length] & 0xC0) == 0x80) {
    --length;  // not within a character of UTF-8
  }
  reason->resize(length);
  return is_one_line(*reason) ? *reason : "";
}

/// The reason why no request reached the printer.
PrinterTrouble unreachable(const Printer& printer, const OutgoingAnswer& answer) {
  if (answer.fingerprint.empty()) {
    return {program_name(printer.kind) + " cannot be reached: " + answer.trouble,
            "Check that it is on and in this network, and its address in the settings."};
  }
  if (printer.fingerprint.empty()) {
    return {"no authority has signed the printer's certificate, whose fingerprint is \"" +
                answer.fingerprint + "\"",
            "Trust it if this is your printer. Nothing was sent to it yet.", answer.fingerprint};
  }
  return {"the printer's certificate is not the trusted one: its fingerprint is \"" +
              answer.fingerprint + "\"",
          "If the printer was set up anew, remove it in the settings and add it again. Otherwise "
          "something else answers at its address. Nothing was sent to it."};
}

constexpr int bad_request = 400;

}  // namespace

std::string printer_file_name(std::string name) {
  std::ranges::replace_if(
      name, [](char c) { return c == '/' || c == '\\' || static_cast<unsigned char>(c) < ' '; },
      '-');
  const std::string ending = std::filesystem::path(name).extension().string();
  std::string stem = name.substr(0, name.size() - ending.size());
  stem.erase(0, std::min(stem.size(), stem.find_first_not_of('.')));
  return (stem.empty() ? "Scan" : stem) + ending;
}

OutgoingRequest upload_request(const Printer& printer, const std::filesystem::path& file,
                               const std::string& name, const std::string& storage) {
  OutgoingRequest request;
  switch (printer.kind) {
    case PrinterKind::octoprint:
      request = authorized(printer, "POST", "/api/files/local");
      request.form_name = name;
      request.fields = {{"select", "false"}, {"print", "false"}};
      break;
    case PrinterKind::moonraker:
      request = authorized(printer, "POST", "/server/files/upload");
      request.form_name = name;
      request.fields = {{"root", "gcodes"}, {"print", "false"}};
      break;
    case PrinterKind::prusalink:
      request = authorized(printer, "PUT", "/api/v1/files" + storage + "/" + to_path_part(name));
      // Booleans of structured fields: RFC 9651, section 3.3.6.
      request.headers.insert(request.headers.end(), {"Content-Type: application/octet-stream",
                                                     "Print-After-Upload: ?0", "Overwrite: ?1"});
      break;
  }
  request.file = file;
  request.time_limit = upload_limit;
  return request;
}

namespace {

/// PrusaLink's `GET /api/v1/storage`, which lists the storages for files.
OutgoingRequest storage_request(const Printer& printer) {
  return authorized(printer, "GET", "/api/v1/storage");
}

}  // namespace

std::optional<std::string> usable_storage(const std::string& body) try {
  const json answer = parse_json(body, ErrorCode::bad_json, "it");
  JsonObject object(answer, ErrorCode::bad_json, "");
  for (const JsonValue& value : object.at("storage_list").elements()) {
    JsonObject storage(value);
    std::string path = storage.at("path").text();
    while (path.ends_with('/')) {
      path.pop_back();
    }
    const bool is_usable =
        storage.flag("available").value_or(true) && !storage.flag("read_only").value_or(false);
    if (is_usable && path.starts_with('/')) {
      return path;
    }
  }
  return std::nullopt;
} catch (const Error&) {
  return std::nullopt;  // not an answer of PrusaLink
}

std::optional<PrinterTrouble> trouble_in(const Printer& printer, const OutgoingAnswer& answer) {
  const std::string program = program_name(printer.kind);
  const std::string answered = program + " answered " + std::to_string(answer.status);
  if (answer.status >= 200 && answer.status < 300) {
    return std::nullopt;
  }
  if (answer.status >= 300 && answer.status < 400) {
    return PrinterTrouble{answered + ", a redirect",
                          "It is not followed: give the printer the address that it leads to."};
  }
  switch (answer.status) {
    case 0:
      return unreachable(printer, answer);
    case 401:
    case 403:
      return PrinterTrouble{answered + ": it does not accept the key",
                            "Give it a key in the settings that may upload files."};
    case 404:
    case 405:
      return PrinterTrouble{answered + ": it has no such address",
                            "Check its kind and its address in the settings."};
    case 409:
      return PrinterTrouble{answered + ": it cannot take the file now",
                            "It may be printing the file of that name. Try again later."};
    case 413:
      return PrinterTrouble{answered + ": the file is too large for it",
                            "Raise its limit, or that of a proxy before it (client_max_body_size "
                            "in nginx), or send a model with a larger leaf size."};
    case 507:
      return PrinterTrouble{answered + ": it has no room for the file",
                            "Delete files there, or send a model with a larger leaf size."};
    case 400: {
      const std::string reason = reason_in(answer.body);
      return PrinterTrouble{
          answered + (reason.empty() ? ": it refuses the file" : ": " + reason),
          "Rename the scan if it is the name. Else look into the log of " + program + "."};
    }
    case 415:
      return PrinterTrouble{answered + ": it does not take this kind of file",
                            slicing_hint(printer.kind)};
    default:
      return PrinterTrouble{answered, "Look into its own log, and try again."};
  }
}

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
