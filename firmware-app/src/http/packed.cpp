#include "http/packed.hpp"

#include <zlib.h>

#include <algorithm>
#include <optional>

namespace octurn {
namespace {

constexpr std::size_t worth_packing = 1024;  // bytes
constexpr int gzip_window = 15 + 16;         // largest window, gzip header: zlib.h, deflateInit2
constexpr int memory_level = 8;              // zlib's default

/// Compresses a text; nothing if zlib is out of memory.
std::optional<std::string> gzip(const std::string& text) {
  z_stream stream{};
  if (::deflateInit2(&stream, Z_DEFAULT_COMPRESSION, Z_DEFLATED, gzip_window, memory_level,
                     Z_DEFAULT_STRATEGY) != Z_OK) {
    return std::nullopt;
  }
  std::string small(::deflateBound(&stream, text.size()), '\0');
  // next_in is not a pointer to const, but zlib only reads through it.
  stream.next_in = const_cast<Bytef*>(reinterpret_cast<const Bytef*>(text.data()));
  stream.avail_in = static_cast<uInt>(text.size());
  stream.next_out = reinterpret_cast<Bytef*>(small.data());
  stream.avail_out = static_cast<uInt>(small.size());
  const bool is_whole = ::deflate(&stream, Z_FINISH) == Z_STREAM_END;
  small.resize(stream.total_out);
  ::deflateEnd(&stream);
  return is_whole ? std::optional(std::move(small)) : std::nullopt;
}

std::string* find_header(Headers& headers, std::string_view name) {
  const auto found = std::ranges::find(headers, name, &Headers::value_type::first);
  return found == headers.end() ? nullptr : &found->second;
}

}  // namespace

bool takes_gzip(const Request& request) {
  std::string_view accepted = request.header("Accept-Encoding").value_or("");
  while (!accepted.empty()) {
    std::string_view one = accepted.substr(0, accepted.find(','));
    accepted.remove_prefix(std::min(one.size() + 1, accepted.size()));
    one.remove_prefix(std::min(one.find_first_not_of(' '), one.size()));
    if (is_of_type(one, "gzip")) {
      const std::size_t weight = one.find("q=");
      return weight == std::string_view::npos ||
             one.find_first_of("123456789", weight) != std::string_view::npos;
    }
  }
  return false;
}

Response packed(const Request& request, Response response) {
  auto* const body = std::get_if<std::string>(&response.body);
  const std::string* const type = find_header(response.headers, "Content-Type");
  if (body == nullptr || type == nullptr || *type != "application/json" ||
      body->size() < worth_packing ||
      find_header(response.headers, "Content-Encoding") != nullptr) {
    return response;
  }
  response.headers.emplace_back("Vary", "Accept-Encoding");
  if (std::string* const tag = find_header(response.headers, "ETag")) {
    tag->insert(0, tag->starts_with("W/") ? "" : "W/");
  }
  if (auto small = takes_gzip(request) ? gzip(*body) : std::nullopt) {
    response.body = std::move(*small);
    response.headers.emplace_back("Content-Encoding", "gzip");
  }
  return response;
}

}  // namespace octurn
