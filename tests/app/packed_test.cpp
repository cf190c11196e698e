#include <fcntl.h>
#include <gtest/gtest.h>
#include <zlib.h>

#include <filesystem>
#include <fstream>

#include "app/response_header.hpp"
#include "http/file_response.hpp"
#include "http/json_body.hpp"
#include "support/temporary_folder.hpp"

namespace octurn {
namespace {

const Request gzip_taker{.headers = {{"Accept-Encoding", "gzip, deflate"}}};

Response long_json() {
  return {.headers = {{"Content-Type", "application/json"}, {"ETag", "\"1f\""}},
          .body = "[" + std::string(5000, ' ') + "]"};
}

/// Decompresses gzip.
std::string unpacked(const std::string& small) {
  std::string text(100'000, '\0');
  z_stream stream{};
  EXPECT_EQ(::inflateInit2(&stream, 15 + 16), Z_OK);
  stream.next_in = const_cast<Bytef*>(reinterpret_cast<const Bytef*>(small.data()));
  stream.avail_in = static_cast<uInt>(small.size());
  stream.next_out = reinterpret_cast<Bytef*>(text.data());
  stream.avail_out = static_cast<uInt>(text.size());
  EXPECT_EQ(::inflate(&stream, Z_FINISH), Z_STREAM_END);
  text.resize(stream.total_out);
  ::inflateEnd(&stream);
  return text;
}

TEST(Packed, IsTheSameJson) {
  const Response small = packed(gzip_taker, long_json());
  EXPECT_EQ(header(small, "Content-Encoding"), "gzip");
  EXPECT_EQ(header(small, "Vary"), "Accept-Encoding");
  EXPECT_LT(std::get<std::string>(small.body).size(), 200U);
  EXPECT_EQ(unpacked(std::get<std::string>(small.body)), std::get<std::string>(long_json().body));
}

TEST(Packed, IsOnlyLongJsonForWhoTakesIt) {
  const Response plain = packed({}, long_json());
  EXPECT_EQ(plain.body.index(), 0U);
  EXPECT_EQ(std::get<std::string>(plain.body), std::get<std::string>(long_json().body));
  EXPECT_EQ(header(plain, "Vary"), "Accept-Encoding");
  Response brief = long_json();
  brief.body = "[]";
  EXPECT_EQ(header(packed(gzip_taker, std::move(brief)), "Content-Encoding"), "");
  Response picture = long_json();
  picture.headers[0].second = "image/png";
  EXPECT_EQ(header(packed(gzip_taker, std::move(picture)), "Content-Encoding"), "");
  Response page = long_json();  // a page's file that was compressed at build time
  page.headers.emplace_back("Content-Encoding", "gzip");
  EXPECT_EQ(std::get<std::string>(packed(gzip_taker, std::move(page)).body),
            std::get<std::string>(long_json().body));
}

Response model(const std::filesystem::path& file) {
  return {.headers = {{"Content-Type", "model/stl"}, {"ETag", "\"1f\""}},
          .body = FileSlice{FileDescriptor(::open(file.c_str(), O_RDONLY | O_CLOEXEC)), 0,
                            std::filesystem::file_size(file)}};
}

TEST(Packed, IsTheSameModel) {
  const TemporaryFolder folder;
  const auto file = folder.path() / "Scan.stl";
  const std::string bytes(50'000, '\1');
  std::ofstream(file, std::ios::binary) << bytes;
  const Response small = packed(gzip_taker, model(file));
  EXPECT_EQ(header(small, "Content-Encoding"), "gzip");
  EXPECT_EQ(header(small, "ETag"), "W/\"1f\"");
  ASSERT_EQ(small.body.index(), 0U);
  EXPECT_EQ(unpacked(std::get<std::string>(small.body)), bytes);

  const Response whole = packed({}, model(file));
  EXPECT_EQ(header(whole, "Content-Encoding"), "");
  EXPECT_EQ(header(whole, "ETag"), "\"1f\"") << "a strong one, for ranges";
  Response part = model(file);
  part.status = 206;
  EXPECT_EQ(header(packed(gzip_taker, std::move(part)), "Content-Encoding"), "");
}

TEST(Packed, IsNoModelThatIsTooLargeForMemory) {
  const TemporaryFolder folder;
  const auto file = folder.path() / "Scan.stl";
  std::ofstream(file).close();
  std::filesystem::resize_file(file, 4'000'001);
  EXPECT_EQ(packed(gzip_taker, model(file)).body.index(), 1U);
}

TEST(Packed, HasATagThatTheClientIsRecognisedBy) {
  Response untagged = long_json();
  untagged.headers.pop_back();
  const auto answer = [&](const Request& request) {
    Response copy{.headers = untagged.headers, .body = std::get<std::string>(untagged.body)};
    return packed(request, tagged(request, std::move(copy)));
  };
  Request again = gzip_taker;
  again.headers.emplace_back("If-None-Match", header(answer(gzip_taker), "ETag"));
  EXPECT_TRUE(header(answer(gzip_taker), "ETag").starts_with("W/"));
  EXPECT_EQ(answer(again).status, 304);
}

}  // namespace
}  // namespace octurn
