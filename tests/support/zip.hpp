#pragma once

#include <gtest/gtest.h>
#include <minizip/unzip.h>

#include <array>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "support/temporary_folder.hpp"
#include "zip_file.hpp"

namespace octurn {

/// The files of a zip archive in their order; none if the archive is invalid.
inline std::vector<ArchivedFile> unzipped(std::string_view archive) {
  const TemporaryFolder folder;
  put(folder.path() / "a.zip", archive);
  const unzFile zip = unzOpen((folder.path() / "a.zip").c_str());
  std::vector<ArchivedFile> files;
  for (int next = unzGoToFirstFile(zip); next == UNZ_OK; next = unzGoToNextFile(zip)) {
    unz_file_info info{};
    std::array<char, 256> name{};
    unzGetCurrentFileInfo(zip, &info, name.data(), name.size(), nullptr, 0, nullptr, 0);
    std::string content(info.uncompressed_size, '\0');
    EXPECT_EQ(unzOpenCurrentFile(zip), UNZ_OK);
    EXPECT_EQ(unzReadCurrentFile(zip, content.data(), static_cast<unsigned>(content.size())),
              static_cast<int>(content.size()));
    EXPECT_EQ(unzCloseCurrentFile(zip), UNZ_OK);  // verifies the checksum
    files.push_back({.name = name.data(), .content = std::move(content)});
  }
  unzClose(zip);
  return files;
}

/// The content of a file in an archive. If there is none, the test fails and the content is empty.
inline std::string content_in(const std::vector<ArchivedFile>& files, std::string_view name) {
  for (const ArchivedFile& file : files) {
    if (file.name == name) {
      return file.content;
    }
  }
  ADD_FAILURE() << "no " << name;
  return "";
}

/// The parsed content of a JSON file in an archive.
inline nlohmann::json json_in(const std::vector<ArchivedFile>& files, std::string_view name) {
  return nlohmann::json::parse(content_in(files, name), nullptr, false);
}

}  // namespace octurn
