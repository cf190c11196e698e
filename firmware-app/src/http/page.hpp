#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "http/message.hpp"

namespace octurn {

/// The folder of the page that belongs to this program: `../share/octurn/web` beside where it is
/// installed, `../page` where it was built.
/// @throws Error "page-missing"  if there is neither
std::filesystem::path page_folder();

/// The files of the page, read once and held in memory: a request can name no other file. A file
/// may have a compressed copy, NAME.gz, for clients that accept it. Files below `assets/` have
/// names that change with their content, so that they may be cached for ever.
class Page {
 public:
  /// @throws Error "page-missing"  if the folder has no index.html
  explicit Page(const std::filesystem::path& folder);

  /// The file of that path, "/" being index.html. @throws Error "not-found"
  Response file(const Request& request) const;

 private:
  struct File {
    std::string content_type = {};
    std::string content = {};
    std::string packed = {};  // by gzip; empty: there is no compressed copy
    std::string tag = {};
  };
  std::map<std::string, File, std::less<>> files_ = {};
};

}  // namespace octurn
