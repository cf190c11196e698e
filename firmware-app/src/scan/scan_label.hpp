#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "scan/job.hpp"

namespace octurn {

// A scan's label has files of its own, as a scan that runs writes `job.json`.

/// What a person writes on a scan.
struct LabelChange {
  std::optional<std::string> name = {};   ///< one line of at most 100 characters; nothing: as it is
  std::optional<std::string> notes = {};  ///< at most 2000 characters; nothing: as they are
};

/// Whether text is a name: one line of at most 100 characters.
bool is_name(const std::string& text);

/// Whether text can be notes: at most 2000 characters, lines and tabs among them, no other control
/// characters.
bool is_notes(const std::string& text);

/// The label after the change.
ScanLabel changed(ScanLabel label, const LabelChange& change);

/// Reads a scan's `name.txt` and `notes.txt`. What is missing, cannot be read, or is too large to
/// be one is empty: the scan itself is none the worse.
ScanLabel read_label(const std::filesystem::path& folder);

/// Writes what changes, each file whole or not at all.
/// @throws Error "disk-full", "write-failed"
void write_label(const std::filesystem::path& folder, const LabelChange& change);

}  // namespace octurn
