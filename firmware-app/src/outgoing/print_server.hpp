#pragma once

#include <filesystem>
#include <optional>
#include <stop_token>
#include <string>

#include "outgoing/address_book.hpp"
#include "outgoing/http_client.hpp"

namespace octurn {

/// Why a printer has not taken a model, for people.
struct PrinterTrouble {
  std::string detail = {};
  std::string hint = {};
};

/// The request that has a print server keep a file and print nothing: OctoPrint's
/// `POST /api/files/local`, Moonraker's `POST /server/files/upload`, PrusaLink's
/// `PUT /api/v1/files/STORAGE/NAME`. An older file of that name is replaced.
/// @param storage  of PrusaLink, such as "/usb"
OutgoingRequest upload_request(const Printer& printer, const std::filesystem::path& file,
                               const std::string& name, const std::string& storage);

/// PrusaLink's `GET /api/v1/storage`, which tells where files can be kept.
OutgoingRequest storage_request(const Printer& printer);

/// The first storage in its answer that can be written to; nothing if there is none.
std::optional<std::string> usable_storage(const std::string& body);

/// What an answer means; nothing: the printer has taken it.
std::optional<PrinterTrouble> trouble_in(const Printer& printer, const OutgoingAnswer& answer);

}  // namespace octurn
