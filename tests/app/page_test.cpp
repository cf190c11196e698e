#include "http/page.hpp"

#include <gtest/gtest.h>

#include "app/response_header.hpp"
#include "support/temporary_folder.hpp"
#include "support/thrown_error.hpp"

namespace octurn {
namespace {

class PageTest : public ::testing::Test {
 protected:
  PageTest() {
    put(folder_.path() / "index.html", "<!doctype html>");
    put(folder_.path() / "app.js", "export {};");
    put(folder_.path() / "lib" / "three.js", "export const REVISION = 1;");
    put(folder_.path() / "notes.md", "not for the page");
    put(folder_.path() / "icon.svg", "<svg/>");
  }

  Response get(const std::string& path, Headers headers = {}) const {
    return Page(folder_.path()).file({.path = path, .headers = std::move(headers)});
  }

  TemporaryFolder folder_;
};

TEST_F(PageTest, GivesItsFilesWithTheirTypes) {
  EXPECT_EQ(std::get<std::string>(get("/").body), "<!doctype html>");
  EXPECT_EQ(header(get("/"), "Content-Type"), "text/html; charset=utf-8");
  EXPECT_EQ(header(get("/app.js"), "Content-Type"), "text/javascript; charset=utf-8");
  EXPECT_EQ(header(get("/icon.svg"), "Content-Type"), "image/svg+xml");
  EXPECT_EQ(std::get<std::string>(get("/lib/three.js").body), "export const REVISION = 1;");
}

TEST_F(PageTest, GivesNothingElse) {
  put(folder_.path().parent_path() / (folder_.path().filename().string() + ".js"), "outside");
  for (const std::string& path :
       std::vector<std::string>{"/notes.md", "/lib", "/lib/", "", "//",
                                "/../" + folder_.path().filename().string() + ".js",
                                "/lib/../app.js", "/app.js/", "/App.js"}) {
    EXPECT_EQ(code_thrown_by([&] { get(path); }), "not-found") << path;
  }
  std::filesystem::remove(folder_.path().string() + ".js");
}

TEST_F(PageTest, IsNotSentAgainUntilItChanges) {
  const std::string tag = header(get("/app.js"), "ETag");
  EXPECT_EQ(get("/app.js", {{"If-None-Match", tag}}).status, 304);
  put(folder_.path() / "app.js", "export { };");
  EXPECT_EQ(get("/app.js", {{"If-None-Match", tag}}).status, 200);
}

TEST_F(PageTest, IsSentPackedToWhoTakesThat) {
  put(folder_.path() / "app.js.gz", "packed");
  for (const char* accepted : {"gzip", "deflate, gzip;q=0.5, br", "br,gzip"}) {
    const Response packed = get("/app.js", {{"Accept-Encoding", accepted}});
    EXPECT_EQ(std::get<std::string>(packed.body), "packed") << accepted;
    EXPECT_EQ(header(packed, "Content-Encoding"), "gzip");
    EXPECT_EQ(header(packed, "Content-Type"), "text/javascript; charset=utf-8");
    EXPECT_EQ(header(packed, "Vary"), "Accept-Encoding");
  }
  for (const char* accepted : {"", "br", "gzip;q=0", "gzip;q=0.0, br", "x-gzipped"}) {
    const Response plain = get("/app.js", {{"Accept-Encoding", accepted}});
    EXPECT_EQ(std::get<std::string>(plain.body), "export {};") << accepted;
    EXPECT_EQ(header(plain, "Content-Encoding"), "");
    EXPECT_EQ(header(plain, "Vary"), "Accept-Encoding");
  }
  EXPECT_EQ(code_thrown_by([&] { get("/app.js.gz"); }), "not-found");
}

TEST_F(PageTest, HasATagForEachOfItsForms) {
  put(folder_.path() / "app.js.gz", "packed");
  const std::string plain = header(get("/app.js"), "ETag");
  const std::string packed = header(get("/app.js", {{"Accept-Encoding", "gzip"}}), "ETag");
  EXPECT_NE(plain, packed);
  EXPECT_EQ(get("/app.js", {{"Accept-Encoding", "gzip"}, {"If-None-Match", packed}}).status, 304);
  EXPECT_EQ(get("/app.js", {{"If-None-Match", packed}}).status, 200);
}

TEST_F(PageTest, IsKeptForEverWhereItsNamesChangeWithTheContent) {
  put(folder_.path() / "assets" / "main-7F3A.js", "1");
  EXPECT_EQ(header(get("/assets/main-7F3A.js"), "Cache-Control"), "max-age=31536000, immutable");
  EXPECT_EQ(header(get("/app.js"), "Cache-Control"), "no-cache");
}

TEST_F(PageTest, SaysThatThereIsNone) {
  EXPECT_EQ(code_thrown_by([&] { Page(folder_.path() / "lib"); }), "page-missing");
}

}  // namespace
}  // namespace octurn
