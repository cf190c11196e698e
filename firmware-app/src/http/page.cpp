#include "http/page.hpp"

#include <algorithm>
#include <array>
#include <fstream>
#include <iterator>

#include "http/file_response.hpp"
#include "octurn/error.hpp"

namespace octurn {
namespace {

namespace fs = std::filesystem;

struct ContentType {
  std::string_view extension;
  std::string_view name;
};

// File types of the page. civetweb's table has neither webmanifest nor character sets.
constexpr std::array content_types{
    ContentType{".html", "text/html; charset=utf-8"},
    ContentType{".css", "text/css; charset=utf-8"},
    ContentType{".js", "text/javascript; charset=utf-8"},
    ContentType{".json", "application/json"},
    ContentType{".webmanifest", "application/manifest+json"},
    ContentType{".svg", "image/svg+xml"},
    ContentType{".png", "image/png"},
    ContentType{".ico", "image/x-icon"},
    ContentType{".woff2", "font/woff2"},
    ContentType{".txt", "text/plain; charset=utf-8"},
    ContentType{".zip", "application/zip"},
};

constexpr std::string_view assets = "/assets/";
constexpr const char* for_ever = "max-age=31536000, immutable";  // a year: RFC 8246

/// The tag of the gzip encoding: a strong tag identifies the encoded bytes (RFC 9110, 8.8.3.3).
std::string packed_tag(std::string tag) {
  tag.insert(tag.size() - 1, "-gzip");
  return tag;
}

std::string read(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  std::string content{std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
  if (!stream) {
    throw Error(ErrorCode::page_missing, file.string() + ": cannot be read");
  }
  return content;
}

[[noreturn]] void no_page(const std::string& where) {
  throw Error(ErrorCode::page_missing, "no page in " + where,
              "Build the target octurn_web, or name the folder with --web.");
}

}  // namespace

fs::path page_folder() {
  const fs::path program = fs::read_symlink("/proc/self/exe").parent_path();
  for (const fs::path folder : {"../share/octurn/web", "../page"}) {
    if (fs::exists(program / folder / "index.html")) {
      return (program / folder).lexically_normal();
    }
  }
  no_page((program / "../page").lexically_normal().string());
}

Page::Page(const fs::path& folder) {
  if (!fs::exists(folder / "index.html")) {
    no_page(folder.string());
  }
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder)) {
    const auto* type = std::ranges::find(content_types, entry.path().extension().string(),
                                         &ContentType::extension);
    if (!entry.is_regular_file() || type == content_types.end()) {
      continue;
    }
    File file{.content_type = std::string(type->name), .content = read(entry.path())};
    if (const fs::path packed = entry.path().string() + ".gz"; fs::exists(packed)) {
      file.packed = read(packed);
    }
    // The tag is of the content: all files of an image have one date, so that a tag of date and
    // size could survive an update.
    file.tag = to_entity_tag(file.content);
    files_.emplace("/" + fs::relative(entry.path(), folder).generic_string(), std::move(file));
  }
}

Response Page::file(const Request& request) const {
  const auto found = files_.find(request.path == "/" ? "/index.html" : request.path);
  if (found == files_.end()) {
    throw Error(ErrorCode::not_found, "there is no " + request.path, "The page is at /.");
  }
  const File& file = found->second;
  const bool is_packed = !file.packed.empty() && takes_gzip(request);
  const std::string tag = is_packed ? packed_tag(file.tag) : file.tag;
  Headers headers{{"ETag", tag},
                  {"Cache-Control", found->first.starts_with(assets) ? for_ever : "no-cache"}};
  if (!file.packed.empty()) {
    headers.emplace_back("Vary", "Accept-Encoding");
  }
  if (client_has(request, tag)) {
    return {.status = 304, .headers = std::move(headers)};
  }
  headers.emplace_back("Content-Type", file.content_type);
  if (is_packed) {
    headers.emplace_back("Content-Encoding", "gzip");
  }
  return {.headers = std::move(headers), .body = is_packed ? file.packed : file.content};
}

}  // namespace octurn
