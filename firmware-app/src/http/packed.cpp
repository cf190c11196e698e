#include "http/packed.hpp"

#include <unistd.h>
#include <zlib.h>

#include <algorithm>
#include <memory>
#include <optional>
#include <semaphore>

namespace octurn {
namespace {

constexpr std::size_t worth_packing = 1024;  // bytes
constexpr int gzip_window = 15 + 16;         // largest window, gzip header: zlib.h, deflateInit2
constexpr int memory_level = 8;              // zlib's default

// A model is compressed in memory: small ones, and few at a time. Larger ones are sent as they are.
constexpr std::uint64_t max_packed_model = 4'000'000;  // bytes
std::counting_semaphore<> packing_models{2};

/// Compresses a text; nothing if zlib is out of memory.
std::optional<std::string> gzip(const std::string& text, int level) {
  z_stream stream{};
  if (::deflateInit2(&stream, level, Z_DEFLATED, gzip_window, memory_level, Z_DEFAULT_STRATEGY) !=
      Z_OK) {
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

/// Reads a part of a file; nothing if it is shorter than that.
std::optional<std::string> read_slice(const FileSlice& slice) {
  std::string bytes(slice.length, '\0');
  std::size_t read = 0;
  while (read < bytes.size()) {
    const ::ssize_t got = ::pread(slice.file.number(), bytes.data() + read, bytes.size() - read,
                                  static_cast<::off_t>(slice.offset + read));
    if (got <= 0) {
      return std::nullopt;
    }
    read += static_cast<std::size_t>(got);
  }
  return bytes;
}

/// Compresses a small model's file, at a level that takes a Pi a tenth of a second for a megabyte.
std::optional<std::string> gzip_model(const FileSlice& model) {
  if (!packing_models.try_acquire()) {
    return std::nullopt;
  }
  const std::unique_ptr<void, void (*)(void*)> turn(&packing_models,
                                                    [](void*) { packing_models.release(); });
  const auto bytes = read_slice(model);
  return bytes ? gzip(*bytes, Z_BEST_SPEED) : std::nullopt;
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
  const auto* const text = std::get_if<std::string>(&response.body);
  const auto* const file = std::get_if<FileSlice>(&response.body);
  const std::string* const type = find_header(response.headers, "Content-Type");
  const bool is_json = text != nullptr && type != nullptr && *type == "application/json" &&
                       text->size() >= worth_packing;
  const bool is_model = file != nullptr && type != nullptr && *type == "model/stl" &&
                        response.status == 200 && file->length <= max_packed_model;
  if (!(is_json || is_model) || find_header(response.headers, "Content-Encoding") != nullptr) {
    return response;
  }
  response.headers.emplace_back("Vary", "Accept-Encoding");
  std::optional<std::string> small;
  if (takes_gzip(request) && (is_json || request.method == "GET")) {
    small = is_json ? gzip(*text, Z_DEFAULT_COMPRESSION) : gzip_model(*file);
  }
  std::string* const tag = find_header(response.headers, "ETag");
  if (tag != nullptr && !tag->starts_with("W/") && (is_json || small)) {
    tag->insert(0, "W/");  // a model that is sent as it is keeps the strong tag that ranges need
  }
  if (small) {
    response.body = std::move(*small);
    response.headers.emplace_back("Content-Encoding", "gzip");
  }
  return response;
}

}  // namespace octurn
