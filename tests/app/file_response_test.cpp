#include "http/file_response.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <nlohmann/json.hpp>

#include "support/temporary_folder.hpp"
#include "support/thrown_error.hpp"

namespace octurn {
namespace {

constexpr std::string_view digits = "0123456789";

class FileResponse : public ::testing::Test {
 protected:
  FileResponse() { put(folder_.path() / "Scan.stl", digits); }

  Response get(Headers headers) const {
    return file_response({.headers = std::move(headers)}, folder_.path() / "Scan.stl", "model/stl",
                         "Scan.stl");
  }
  Response range(const char* range) const { return get({{"Range", range}}); }
  std::string tag() const { return value_of(get({}), "ETag"); }

  static std::string value_of(const Response& response, std::string_view name) {
    for (const auto& [key, value] : response.headers) {
      if (key == name) {
        return value;
      }
    }
    return "";
  }

  static std::string content(const Response& response) {
    const auto& slice = std::get<FileSlice>(response.body);
    std::string text(slice.length, '\0');
    const ssize_t got =
        ::pread(slice.file.number(), text.data(), text.size(), static_cast<off_t>(slice.offset));
    text.resize(static_cast<std::size_t>(std::max<ssize_t>(got, 0)));
    return text;
  }

  TemporaryFolder folder_;
};

TEST_F(FileResponse, IsTheWholeFile) {
  const Response response = get({});
  EXPECT_EQ(response.status, 200);
  EXPECT_EQ(content(response), digits);
  EXPECT_EQ(value_of(response, "Content-Type"), "model/stl");
  EXPECT_EQ(value_of(response, "Accept-Ranges"), "bytes");
  EXPECT_EQ(value_of(response, "Content-Disposition"),
            "attachment; filename=\"Scan.stl\"; filename*=UTF-8''Scan.stl");
}

TEST_F(FileResponse, GivesAPlainNameToProgramsOfOldToo) {
  EXPECT_EQ(attachment("hare-2.stl"),
            "attachment; filename=\"hare-2.stl\"; filename*=UTF-8''hare-2.stl");
}

TEST_F(FileResponse, EncodesANameThatAHeaderCannotHold) {
  const Response response =
      file_response({}, folder_.path() / "Scan.stl", "model/stl", "gr\u00fcn\" \r\nX: 1.stl");
  EXPECT_EQ(
      value_of(response, "Content-Disposition"),
      "attachment; filename=\"Scan.stl\"; filename*=UTF-8''gr%C3%BCn%22%20%0D%0AX%3A%201.stl");
}

TEST_F(FileResponse, IsThePartAskedFor) {
  const std::vector<std::array<const char*, 3>> cases{
      {"bytes=0-3", "0123", "bytes 0-3/10"},
      {"bytes=4-4", "4", "bytes 4-4/10"},
      {"bytes=7-", "789", "bytes 7-9/10"},
      {"bytes=-2", "89", "bytes 8-9/10"},
      {"bytes=8-100", "89", "bytes 8-9/10"},
      {"bytes=-100", "0123456789", "bytes 0-9/10"},
      {"bytes=0-18446744073709551615", "0123456789", "bytes 0-9/10"},
  };
  for (const auto& [header, expected, part] : cases) {
    const Response response = range(header);
    EXPECT_EQ(response.status, 206) << header;
    EXPECT_EQ(content(response), expected) << header;
    EXPECT_EQ(value_of(response, "Content-Range"), part) << header;
  }
}

TEST_F(FileResponse, RefusesAPartOutside) {
  for (const char* const header : {"bytes=10-", "bytes=10-20", "bytes=-0", "bytes=99-"}) {
    const Response response = range(header);
    EXPECT_EQ(response.status, 416) << header;
    EXPECT_EQ(value_of(response, "Content-Range"), "bytes */10") << header;
  }
}

TEST_F(FileResponse, IsTheWholeWhereTheRangeIsMalformedOrManyOrOfAnotherUnit) {
  for (const char* const header :
       {"", "bytes", "bytes=", "bytes=-", "bytes=a-b", "bytes=3-1", "bytes= 0-1", "bytes=0-1,3-4",
        "bytes=0x1-2", "bytes=+1-2", "lines=0-1", "bytes=1-99999999999999999999", "bytes=--2"}) {
    const Response response = range(header);
    EXPECT_EQ(response.status, 200) << header;
    EXPECT_EQ(content(response), digits) << header;
  }
}

TEST_F(FileResponse, IgnoresARangeOfAHead) {
  const Response response = file_response({.method = "HEAD", .headers = {{"Range", "bytes=0-1"}}},
                                          folder_.path() / "Scan.stl", "model/stl", "Scan.stl");
  EXPECT_EQ(response.status, 200);
  EXPECT_EQ(std::get<FileSlice>(response.body).length, digits.size());
}

TEST_F(FileResponse, IsNotSentAgainToWhoHasIt) {
  EXPECT_EQ(get({{"If-None-Match", tag()}}).status, 304);
  EXPECT_EQ(get({{"If-None-Match", "\"other\", " + tag()}}).status, 304);
  EXPECT_EQ(get({{"If-None-Match", "*"}}).status, 304);
  EXPECT_EQ(get({{"if-none-match", "W/" + tag()}}).status, 304);
  EXPECT_EQ(get({{"If-None-Match", "\"other\""}}).status, 200);
}

TEST_F(FileResponse, ContinuesOnlyTheSameFile) {
  const Headers same{{"Range", "bytes=5-"}, {"If-Range", tag()}};
  const Headers other{{"Range", "bytes=5-"}, {"If-Range", "\"other\""}};
  EXPECT_EQ(get(same).status, 206);
  EXPECT_EQ(get(other).status, 200);
  EXPECT_EQ(get({{"If-Match", tag()}}).status, 200);
  EXPECT_EQ(code_thrown_by([&] { get({{"If-Match", "\"other\""}}); }), "changed");
  EXPECT_EQ(code_thrown_by([&] { get({{"If-Match", "W/" + tag()}}); }), "changed");
  EXPECT_EQ(get({{"Range", "bytes=5-"}, {"If-Range", "W/" + tag()}}).status, 200);
}

TEST_F(FileResponse, HasAnotherTagOnceTheFileIsReplaced) {
  const std::string before = tag();
  put(folder_.path() / "new", digits);
  std::filesystem::rename(folder_.path() / "new", folder_.path() / "Scan.stl");
  EXPECT_NE(tag(), before);
}

TEST_F(FileResponse, SendsNothingThatIsNoRegularFile) {
  const auto answer = [&](const char* name) {
    return code_thrown_by([&] { file_response({}, folder_.path() / name, "model/stl", ""); });
  };
  std::filesystem::create_symlink("/etc/passwd", folder_.path() / "link");
  EXPECT_EQ(answer("missing"), "no-model");
  EXPECT_EQ(answer("."), "no-model");
  EXPECT_EQ(answer("link"), "no-model");
}

TEST_F(FileResponse, HandlesAnEmptyFile) {
  put(folder_.path() / "Scan.stl", "");
  EXPECT_EQ(get({}).status, 200);
  EXPECT_EQ(range("bytes=0-").status, 416);
  EXPECT_EQ(range("bytes=-1").status, 416);
}

}  // namespace
}  // namespace octurn
