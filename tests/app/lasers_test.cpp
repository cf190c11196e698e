#include "camera/lasers.hpp"

#include <gtest/gtest.h>

#include <memory>
#include <stdexcept>
#include <string>

#include "support/thrown_error.hpp"

namespace octurn {
namespace {

/// Two GPIO lines, which are held as long as a function that sets them lives.
struct Header {
  std::string changes = {};  ///< A and B for on, a and b for off
  bool is_broken = false;
  std::weak_ptr<int> use = {};

  Lasers::SetLine open() {
    const auto held = std::make_shared<int>();
    use = held;
    return [this, held](std::size_t laser, bool on) {
      if (is_broken) {
        throw std::runtime_error("the kernel says no");
      }
      changes += static_cast<char>((on ? 'A' : 'a') + static_cast<char>(laser));
    };
  }
  bool is_in_use() const { return !use.expired(); }
};

TEST(Lasers, AreOffAtTheStartAndAtTheEnd) {
  Header header;
  {
    const Lasers lasers(2, header.open());
    EXPECT_EQ(header.changes, "ab");
    EXPECT_TRUE(header.is_in_use());
  }
  EXPECT_EQ(header.changes, "abab");
  EXPECT_FALSE(header.is_in_use());
}

TEST(Lasers, AreOnWhileTheirLightLives) {
  Header header;
  Lasers lasers(2, header.open());
  {
    const Lasers::Light light = lasers.light(1);
    EXPECT_EQ(header.changes, "abB");
  }
  EXPECT_EQ(header.changes, "abBb");
}

TEST(Lasers, AreOffAfterWhateverLeavesAPicture) {
  Header header;
  Lasers lasers(1, header.open());
  EXPECT_THROW(
      {
        const Lasers::Light light = lasers.light(0);
        throw std::runtime_error("the camera is gone");
      },
      std::runtime_error);
  EXPECT_EQ(header.changes, "aAa");
}

TEST(Lasers, ReleaseAllLinesWhereOneCannotBeSwitchedOff) {
  Header header;
  Lasers lasers(2, header.open());
  {
    const Lasers::Light light = lasers.light(0);
    header.is_broken = true;
  }
  EXPECT_FALSE(header.is_in_use());
  header.is_broken = false;
  EXPECT_EQ(code_thrown_by([&] { const Lasers::Light light = lasers.light(1); }), "sensor-failed");
  EXPECT_EQ(header.changes, "abA");
}

TEST(Lasers, ReleaseAllLinesWhereOneCannotBeSwitchedOn) {
  Header header;
  Lasers lasers(1, header.open());
  header.is_broken = true;
  EXPECT_THROW({ const Lasers::Light light = lasers.light(0); }, std::runtime_error);
  EXPECT_FALSE(header.is_in_use());
}

TEST(Lasers, HaveNoLineWithoutAHeader) {
  const Error error = error_thrown_by([] { open_laser_lines({"GPIO23"}); });
  EXPECT_EQ(error.code(), ErrorCode::sensor_missing);
  EXPECT_NE(std::string(error.what()).find("lasers: "), std::string::npos) << error.what();
}

}  // namespace
}  // namespace octurn
