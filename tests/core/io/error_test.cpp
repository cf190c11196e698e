#include "octurn/error.hpp"

#include <gtest/gtest.h>

#include <set>
#include <string>

namespace octurn {
namespace {

TEST(ErrorCode, HasAWordOfItsOwnThatLeadsBackToIt) {
  std::set<std::string> words;
  for (int i = 0; i <= static_cast<int>(ErrorCode::unknown); ++i) {
    const auto code = static_cast<ErrorCode>(i);
    const std::string word(to_string(code));
    EXPECT_TRUE(words.insert(word).second) << word;
    EXPECT_EQ(to_error_code(word), code) << word;
  }
}

TEST(ErrorCode, IsReadByTheWordOfVersion01) {
  EXPECT_EQ(to_error_code("model-empty"), ErrorCode::model_empty);
}

TEST(ErrorCode, IsNoneForAWordOfANewerVersion) {
  EXPECT_EQ(to_error_code("moon-full"), std::nullopt);
}

}  // namespace
}  // namespace octurn
