#include "store/scan_label.hpp"

#include <algorithm>
#include <cstddef>
#include <string_view>

#include "octurn/error.hpp"
#include "octurn/file.hpp"
#include "one_line.hpp"

namespace octurn {
namespace {

namespace fs = std::filesystem;

constexpr const char* name_file = "name.txt";
constexpr const char* notes_file = "notes.txt";
constexpr std::size_t max_bytes = 16384;
constexpr std::ptrdiff_t max_name = 100;    // characters
constexpr std::ptrdiff_t max_notes = 2000;  // characters

/// Counts code points of UTF-8 text: all bytes but continuation bytes, which begin with bits 10.
std::ptrdiff_t count_characters(std::string_view text) {
  return std::ranges::count_if(
      text, [](char c) { return (static_cast<unsigned char>(c) & 0xC0U) != 0x80U; });
}

std::string read_text(const fs::path& file) {
  try {
    return read_regular_file(file, max_bytes).value_or("");
  } catch (const Error&) {
    return "";
  }
}

}  // namespace

bool is_name(const std::string& text) {
  return count_characters(text) <= max_name && is_one_line(text);
}

bool is_notes(const std::string& text) {
  std::string line = text;
  std::erase_if(line, [](char c) { return c == '\n' || c == '\t'; });
  return count_characters(text) <= max_notes && is_one_line(line);
}

ScanLabel changed(ScanLabel label, const LabelChange& change) {
  label.name = change.name.value_or(label.name);
  label.notes = change.notes.value_or(label.notes);
  return label;
}

ScanLabel read_label(const fs::path& folder) {
  return {.name = read_text(folder / name_file), .notes = read_text(folder / notes_file)};
}

void write_label(const fs::path& folder, const LabelChange& change) {
  if (change.name) {
    write_file(folder / name_file, *change.name);
  }
  if (change.notes) {
    write_file(folder / notes_file, *change.notes);
  }
}

}  // namespace octurn
