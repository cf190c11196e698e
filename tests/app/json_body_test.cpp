#include "http/json_body.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "app/response_header.hpp"

namespace octurn {
namespace {

Response answer(int snapshots, Headers headers = {}, const std::string& method = "GET") {
  return tagged({.method = method, .headers = std::move(headers)},
                json_response({{"snapshots", snapshots}}));
}

TEST(TaggedJson, IsSentOnceToWhoKeepsIt) {
  const Response first = answer(3);
  const std::string tag = header(first, "ETag");
  EXPECT_EQ(first.status, 200);
  EXPECT_EQ(header(first, "Content-Type"), "application/json");

  const Response again = answer(3, {{"If-None-Match", tag}});
  EXPECT_EQ(again.status, 304);
  EXPECT_EQ(std::get<std::string>(again.body), "");
  EXPECT_EQ(header(again, "ETag"), tag);

  const Response changed = answer(4, {{"If-None-Match", tag}});
  EXPECT_EQ(changed.status, 200);
  EXPECT_NE(header(changed, "ETag"), tag);
}

TEST(TaggedJson, IsNoAnswerToAnOrderAndNoFile) {
  EXPECT_EQ(header(answer(3, {}, "POST"), "ETag"), "");
  Response file{.headers = {{"Content-Type", "application/zip"}}, .body = "PK"};
  EXPECT_EQ(header(tagged({}, std::move(file)), "ETag"), "");
}

}  // namespace
}  // namespace octurn
