#pragma once

#include <filesystem>
#include <optional>
#include <stop_token>
#include <string>

#include "outgoing/address_book.hpp"
#include "outgoing/http_client.hpp"

namespace octurn {

/// Readable reason why a printer has not accepted a model.
struct PrinterTrouble {
  std::string detail = {};
  std::string hint = {};
};

/// A file's name for a print server: without what it would take as a folder, or as hidden.
std::string printer_file_name(std::string name);

/// The request that uploads a file to a print server without printing it: OctoPrint's
/// `POST /api/files/local`, Moonraker's `POST /server/files/upload`, PrusaLink's
/// `PUT /api/v1/files/STORAGE/NAME`. An older file of that name is replaced.
/// @param storage  path of PrusaLink's storage, such as "/usb"; others ignore it
OutgoingRequest upload_request(const Printer& printer, const std::filesystem::path& file,
                               const std::string& name, const std::string& storage);

/// PrusaLink's `GET /api/v1/storage`, which lists the storages for files.
OutgoingRequest storage_request(const Printer& printer);

/// The path of the first writable storage in the body of that answer; nothing if there is none.
std::optional<std::string> usable_storage(const std::string& body);

/// The reason for which an answer refuses an upload; nothing if the printer has accepted it.
std::optional<PrinterTrouble> trouble_in(const Printer& printer, const OutgoingAnswer& answer);

}  // namespace octurn
