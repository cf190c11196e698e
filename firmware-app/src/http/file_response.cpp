#include "http/file_response.hpp"

#include <fcntl.h>
#include <sys/stat.h>

#include <charconv>
#include <cstdio>

#include "http/entity_tags.hpp"
#include "http/problem.hpp"

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

}  // namespace octurn
