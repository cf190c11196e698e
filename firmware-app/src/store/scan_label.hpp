#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "store/job.hpp"

namespace octurn {

// A scan's label has its own files, because a running scan writes `job.json`.

/// A change of a scan's label.
struct LabelChange {
  std::optional<std::string> name = {};  ///< one line of at most 100 characters; nullopt: unchanged
  std::optional<std::string> notes = {};  ///< at most 2000 characters; nullopt: unchanged
};

/// Whether text is a valid name: one line of at most 100 characters.
bool is_name(const std::string& text);

/// Whether text is valid as notes: at most 2000 characters, and no control characters except line
/// feeds and tabs.
bool is_notes(const std::string& text);

/// Returns the label after the change.
ScanLabel changed(ScanLabel label, const LabelChange& change);

/// Reads a scan's `name.txt` and `notes.txt`. One that is missing, unreadable or too large is
/// empty.
ScanLabel read_label(const std::filesystem::path& folder);

/// Writes the changed files, each atomically.
/// @throws Error "disk-full", "write-failed"
void write_label(const std::filesystem::path& folder, const LabelChange& change);

}  // namespace octurn
