#include "outgoing/print_server.hpp"

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "one_line.hpp"

namespace octurn {
namespace {

using nlohmann::json;

/// Long, as slow uploads are fine: the HTTP client gives up those that stall.
constexpr std::chrono::hours upload_limit{1};

OutgoingRequest authorized(const Printer& printer, std::string method, const std::string& path) {
  OutgoingRequest request{.method = std::move(method), .url = printer.url + path};
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

OutgoingRequest storage_request(const Printer& printer) {
  return authorized(printer, "GET", "/api/v1/storage");
}

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
      return PrinterTrouble{
          program + " cannot be reached: " + answer.trouble,
          "Check that it is on and in this network, and its address in the settings."};
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

}  // namespace octurn
