#include "http/entity_tags.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdint>
#include <optional>

namespace octurn {
namespace {

struct EntityTag {
  std::string_view text = {};  // with its quotes
  bool is_weak = false;
};

void skip_separators(std::string_view& list) {
  list.remove_prefix(std::min(list.find_first_not_of(" \t,"), list.size()));
}

/// Takes the next tag from a list. @return nothing at its end, or if it is malformed there
std::optional<EntityTag> next_tag(std::string_view& list) {
  skip_separators(list);
  EntityTag tag;
  if (list.starts_with("W/")) {
    tag.is_weak = true;
    list.remove_prefix(2);
  }
  const std::size_t end = list.find('"', 1);
  if (!list.starts_with('"') || end == std::string_view::npos) {
    return std::nullopt;
  }
  tag.text = list.substr(0, end + 1);
  list.remove_prefix(end + 1);
  const bool is_separated = list.empty() || list.find_first_of(" \t,") == 0;
  return is_separated ? std::optional(tag) : std::nullopt;
}

template <class Compare>
bool matches(std::string_view field, Compare is_same) {
  if (field == "*") {
    return true;
  }
  while (const auto tag = next_tag(field)) {
    if (is_same(*tag)) {
      return true;
    }
  }
  return false;
}

}  // namespace

// 64-bit FNV-1a
std::string to_entity_tag(std::string_view content) {
  std::uint64_t hash = 0xcbf29ce484222325U;
  for (const char c : content) {
    hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3U;
  }
  std::array<char, 16> digits{};
  const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), hash, 16).ptr;
  return "\"" + std::string(digits.data(), end) + "\"";
}

bool matches_strongly(std::string_view field, std::string_view tag) {
  return matches(field,
                 [&](const EntityTag& other) { return !other.is_weak && other.text == tag; });
}

bool matches_weakly(std::string_view field, std::string_view tag) {
  return matches(field, [&](const EntityTag& other) { return other.text == tag; });
}

bool client_has(const Request& request, std::string_view tag) {
  const auto known = request.header("If-None-Match");
  return known && matches_weakly(*known, tag);
}

}  // namespace octurn
