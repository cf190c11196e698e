#include <gtest/gtest.h>

#include "http/file_response.hpp"

namespace octurn {
namespace {

constexpr std::string_view tag = R"("a-1")";

/// Header fields that contain the tag as a strong validator.
constexpr const char* strong_fields[] = {R"("a-1")",          R"("b", "a-1")", R"("b","a-1","c")",
                                         R"(W/"a-1", "a-1")", R"( , "a-1" ,)", "*",
                                         R"("b,c" , "a-1")"};

/// Header fields that do not contain the tag, although some contain its text.
constexpr const char* other_fields[] = {
    "",           R"("a-12")",    R"("b"a-1")", R"(a-1)",       R"("a-1)",
    R"(x"a-1")",  R"("x"a-1"y")", R"(w/"a-1")", R"("b" * "c")", R"("*")",
    R"(W/ "a-1")"};

TEST(EntityTags, FindAStrongTagByEitherComparison) {
  for (const char* const field : strong_fields) {
    EXPECT_TRUE(matches_strongly(field, tag)) << field;
    EXPECT_TRUE(matches_weakly(field, tag)) << field;
  }
}

TEST(EntityTags, FindAWeakTagByTheWeakComparisonOnly) {
  for (const char* const field : {R"(W/"a-1")", R"("b", W/"a-1")"}) {
    EXPECT_FALSE(matches_strongly(field, tag)) << field;
    EXPECT_TRUE(matches_weakly(field, tag)) << field;
  }
}

TEST(EntityTags, DoNotFindWhatOnlyContainsTheTag) {
  for (const char* const field : other_fields) {
    EXPECT_FALSE(matches_strongly(field, tag)) << field;
    EXPECT_FALSE(matches_weakly(field, tag)) << field;
  }
}

}  // namespace
}  // namespace octurn
