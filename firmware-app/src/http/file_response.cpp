#include "http/file_response.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdint>
#include <cstdio>
#include <memory>
#include <optional>
#include <semaphore>

#include "http/json_body.hpp"

namespace octurn {
namespace {

struct ByteRange {
  std::uint64_t first = 0;
  std::uint64_t last = 0;  // included
};

/// The part of a file that a Range header asks for.
struct RangeRequest {
  enum class Extent { whole, part, outside };
  Extent extent = Extent::whole;
  ByteRange range = {};
};

/// A decimal number without sign; nothing if the text is anything else, or too large.
std::optional<std::uint64_t> parse_number(std::string_view text) {
  std::uint64_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  const bool whole = error == std::errc() && end == text.data() + text.size();
  return whole ? std::optional(value) : std::nullopt;
}

/// Parses a Range header for a file of `size` bytes. A malformed header, or one with several
/// ranges, selects the whole file.
RangeRequest parse_range(std::string_view header, std::uint64_t size) {
  constexpr std::string_view unit = "bytes=";
  const std::size_t dash = header.find('-');
  if (!header.starts_with(unit) || dash == std::string_view::npos) {
    return {};
  }
  const std::string_view before = header.substr(unit.size(), dash - unit.size());
  const std::string_view after = header.substr(dash + 1);
  const auto first = parse_number(before);
  const auto last = parse_number(after);
  if ((!first && !before.empty()) || (!last && !after.empty()) || (!first && !last) ||
      (first && last && *last < *first)) {
    return {};
  }
  if (first ? *first >= size : *last == 0 || size == 0) {
    return {.extent = RangeRequest::Extent::outside};
  }
  if (!first) {  // a suffix range: the last bytes
    return {.extent = RangeRequest::Extent::part,
            .range = {.first = size - std::min(*last, size), .last = size - 1}};
  }
  return {.extent = RangeRequest::Extent::part,
          .range = {.first = *first, .last = last ? std::min(*last, size - 1) : size - 1}};
}

/// An entity tag of inode, size and time. It differs between versions of a file, as each version is
/// a new file that is renamed over the old one.
std::string to_file_tag(const struct ::stat& info) {
  std::array<char, 80> text{};
  const int length = std::snprintf(
      text.data(), text.size(), "\"%jx-%jx-%jx.%lx\"", static_cast<std::uintmax_t>(info.st_ino),
      static_cast<std::uintmax_t>(info.st_size), static_cast<std::uintmax_t>(info.st_mtim.tv_sec),
      static_cast<unsigned long>(info.st_mtim.tv_nsec));
  return {text.data(), static_cast<std::size_t>(length)};
}

/// A name as percent-encoded UTF-8 (RFC 8187, section 3.2). mg_url_encode does not encode ';' and
/// ',', which end a parameter.
std::string percent_encoded(std::string_view text) {
  constexpr std::string_view plain =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-._";
  std::string encoded;
  for (const char c : text) {
    if (plain.find(c) != std::string_view::npos) {
      encoded += c;
    } else {
      std::array<char, 4> code{};
      std::snprintf(code.data(), code.size(), "%%%02X", static_cast<unsigned char>(c));
      encoded += code.data();
    }
  }
  return encoded;
}

}  // namespace

std::string attachment(std::string_view name) {
  const std::string encoded = percent_encoded(name);
  const std::string ending(name.substr(std::min(name.rfind('.'), name.size())));
  const std::string plain =
      encoded == name ? encoded : "Scan" + ending;  // for clients without RFC 8187
  return "attachment; filename=\"" + plain + "\"; filename*=UTF-8''" + encoded;
}

Response file_response(const Request& request, const std::filesystem::path& file,
                       const std::string& content_type, const std::string& name) {
  FileDescriptor descriptor(
      ::open(file.c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK));  // a FIFO would wait
  struct ::stat info {};
  if (!descriptor.is_open() || ::fstat(descriptor.number(), &info) != 0 || !S_ISREG(info.st_mode)) {
    throw Error(ErrorCode::no_model, "the file of this model is missing",
                "Start a new scan, or rebuild it with octurn reconstruct.");
  }
  const auto size = static_cast<std::uint64_t>(info.st_size);
  const std::string tag = to_file_tag(info);
  Headers headers{{"ETag", tag}, {"Accept-Ranges", "bytes"}, {"Cache-Control", "no-cache"}};
  if (const auto wanted = request.header("If-Match"); wanted && !matches_strongly(*wanted, tag)) {
    throw Error(ErrorCode::changed, "the model was replaced since it was first read",
                "Download it again.");
  }
  if (client_has(request, tag)) {
    return {.status = 304, .headers = std::move(headers)};
  }

  RangeRequest wanted;
  const bool same = request.header("If-Range").value_or(tag) == tag;
  if (const auto range = request.header("Range"); range && request.method == "GET" && same) {
    wanted = parse_range(*range, size);
  }
  if (wanted.extent == RangeRequest::Extent::outside) {
    Response response = problem({.code = ErrorCode::bad_range,
                                 .detail = "the model has " + std::to_string(size) + " bytes",
                                 .hint = "Ask for a part within them."});
    response.headers.emplace_back("Content-Range", "bytes */" + std::to_string(size));
    return response;
  }
  headers.emplace_back("Content-Type", content_type);
  headers.emplace_back("Content-Disposition", attachment(name));
  if (wanted.extent == RangeRequest::Extent::whole) {
    return {.headers = std::move(headers), .body = FileSlice{std::move(descriptor), 0, size}};
  }
  const auto [first, last] = wanted.range;
  headers.emplace_back("Content-Range", "bytes " + std::to_string(first) + "-" +
                                            std::to_string(last) + "/" + std::to_string(size));
  return {.status = 206,
          .headers = std::move(headers),
          .body = FileSlice{std::move(descriptor), first, last - first + 1}};
}

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
