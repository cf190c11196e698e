#include <algorithm>
#include <cstring>
#include <limits>
#include <string>
#include <string_view>
#include <utility>

#include "octurn/error.hpp"
#include "octurn/file.hpp"
#include "octurn/stl.hpp"

namespace octurn {

std::array<std::byte, 84> stl_header(std::uint64_t facets) {
  if (facets > std::numeric_limits<std::uint32_t>::max()) {
    throw Error(ErrorCode::model_too_large,
                std::to_string(facets) + " triangles: an STL holds 4294967295",
                "Choose a larger leaf size.");
  }
  constexpr std::string_view title = "Octurn, millimetres";  // must not begin with "solid"
  std::array<std::byte, 84> header{};
  std::ranges::copy(std::as_bytes(std::span(title)), header.begin());
  const auto count = static_cast<std::uint32_t>(facets);
  std::memcpy(&header[80], &count, sizeof count);
  return header;
}

std::string stl_text(std::span<const Facet> facets) {
  const auto header = stl_header(facets.size());
  const std::span<const std::byte> bytes = std::as_bytes(facets);
  std::string text;
  text.reserve(header.size() + bytes.size());
  text.append(reinterpret_cast<const char*>(header.data()), header.size());
  text.append(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  return text;
}

StlFile::StlFile(std::filesystem::path target)
    : file_(std::make_unique<AtomicFile>(std::move(target))) {
  file_->write(stl_header(0));
}

StlFile::~StlFile() = default;

void StlFile::write(std::span<const Facet> facets) {
  file_->write(std::as_bytes(facets));
  facets_ += facets.size();
}

void StlFile::commit() {
  file_->write_at(0, stl_header(facets_));
  file_->commit();
}

}  // namespace octurn
