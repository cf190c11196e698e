#include <gtest/gtest.h>

#include <string>

#include "http/password_file.hpp"

namespace octurn {
namespace {

/// The example of RFC 7616, section 3.9.1, with MD5.
const std::string example =
    R"(Digest username="Mufasa", realm="http-auth@example.org", uri="/dir/index.html", )"
    R"(algorithm=MD5, nonce="7ypf/xlj9XXwfDPEoM4URrv/xwf94BcCAzFZH4GiTo0v", nc=00000001, )"
    R"(cnonce="f2/wE4q74E6zIJEtWaHKaf5wv/H5QzzpXusqGemxURZJ", qop=auth, )"
    R"(response="8ca523f5e9506fed4657c9700eebdbec", opaque="FQhe/qaU925kfnzjCev0ciny7QMkPqMAFRtzCUYo5tdS")";

TEST(Digest, HasTheResponseOfTheStandardsExample) {
  const auto proof = parse_digest(example);
  ASSERT_TRUE(proof);
  EXPECT_EQ(proof->user, "Mufasa");
  EXPECT_EQ(proof->realm, "http-auth@example.org");
  EXPECT_EQ(proof->uri, "/dir/index.html");
  EXPECT_EQ(proof->nc, "00000001");
  const std::string hash = digest_hash("Mufasa", "http-auth@example.org", "Circle of Life");
  EXPECT_EQ(digest_response(*proof, hash, "GET"), proof->response);
  EXPECT_EQ(proof->response, "8ca523f5e9506fed4657c9700eebdbec");
  EXPECT_NE(digest_response(*proof, hash, "POST"), proof->response);
}

TEST(Digest, ReadsQuotedLettersAndBlanks) {
  const auto proof = parse_digest("digest  USERNAME = \"a\\\"b\\\\c, d=e\" ,,\tqop = auth,");
  ASSERT_TRUE(proof);
  EXPECT_EQ(proof->user, R"(a"b\c, d=e)");
  EXPECT_EQ(proof->qop, "auth");
}

TEST(Digest, IsNothingIfMalformedOrOfAnotherScheme) {
  for (const std::string& text :
       {std::string(), std::string("Basic b2N0dXJuOm9wZW4="), std::string("Digest username"),
        std::string("Digest username=\"a"), std::string("Digest username=\"a\\"),
        std::string("Digest =\""), std::string("Digestusername=\"a\"")}) {
    EXPECT_FALSE(parse_digest(text)) << text;
  }
}

// Every prefix of a header, and the header with any letter replaced, is parsed or refused.
TEST(Digest, EndsForWhateverIsCutOffOrReplaced) {
  for (std::size_t i = 0; i < example.size(); ++i) {
    parse_digest(example.substr(0, i));
    for (const char letter : {'"', '\\', '=', ',', ' ', '\0'}) {
      std::string text = example;
      text[i] = letter;
      parse_digest(text);
    }
  }
}

}  // namespace
}  // namespace octurn
