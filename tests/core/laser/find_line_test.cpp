#include "laser/find_line.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>

#include "octurn/light_channel.hpp"
#include "support/random.hpp"

namespace octurn {
namespace {

constexpr int width = 120;
constexpr int height = 60;

/// Light at a pixel's centre, grey levels.
using Light = std::function<double(double u, int v)>;

Picture draw(const Light& light) {
  Picture picture{.width = width, .height = height, .samples = {}};
  for (int v = 0; v < height; ++v) {
    for (int u = 0; u < width; ++u) {
      picture.samples.push_back(
          static_cast<std::uint8_t>(std::clamp(std::lround(light(u, v)), 0L, 255L)));
    }
  }
  return picture;
}

double line(double u, double middle, double peak, double deviation = 1.2) {
  const double off = (u - middle) / deviation;
  return peak * std::exp(-off * off / 2);
}

const Picture no_light = draw([](double, int) { return 0; });

TEST(FindLine, FindsItsColumnToAFractionOfAPixel) {
  const auto middle = [](int v) { return 40.3 + 0.23 * v; };
  const Picture lit = draw([&](double u, int v) { return line(u, middle(v), 150); });

  const std::vector<LineSample> samples = find_line(no_light, lit, {});

  ASSERT_EQ(samples.size(), static_cast<std::size_t>(height - 2));  // all but first and last row
  for (const LineSample& sample : samples) {
    EXPECT_NEAR(sample.u, middle(sample.row), 0.02) << "row " << sample.row;  // 8 bits a pixel
  }
}

/// A line on a real surface: the halo's share of the peak 5, 10, 20 and 40 pixels to each side.
/// Measured on a green laser, a lens of 640 x 480 and JPEG.
struct Surface {
  const char* name;
  double width;  // pixels at half of the peak
  std::array<double, 4> left;
  std::array<double, 4> right;
};

double halo(const std::array<double, 4>& shares, double off) {
  constexpr std::array<double, 4> at{5, 10, 20, 40};
  if (off <= at.front()) {
    return shares.front();
  }
  for (std::size_t i = 1; i < at.size(); ++i) {
    if (off <= at[i]) {
      return std::lerp(shares[i - 1], shares[i], (off - at[i - 1]) / (at[i] - at[i - 1]));
    }
  }
  return 0;
}

TEST(FindLine, IsNotDrawnAsideByTheHaloOfARealSurface) {
  for (const Surface& on :
       {Surface{"plastic", 3, {0.06, 0.02, 0.02, 0.01}, {0.04, 0.01, 0.01, 0.005}},
        Surface{"plaster", 5, {0.18, 0.08, 0.03, 0.01}, {0.23, 0.08, 0.02, 0.01}},
        Surface{"paper", 5, {0.38, 0.30, 0.28, 0.27}, {0.34, 0.24, 0.13, 0.03}}}) {
    const auto middle = [](int v) { return 55.3 + 0.13 * v; };
    const Picture lit = draw([&](double u, int v) {
      const double off = u - middle(v);
      const double share = halo(off < 0 ? on.left : on.right, std::abs(off));
      return line(off, 0, 180 * (1 - share), on.width / 2.355) + 180 * share;
    });

    const std::vector<LineSample> samples = find_line(no_light, lit, {});

    ASSERT_EQ(samples.size(), static_cast<std::size_t>(height - 2)) << on.name;
    for (const LineSample& sample : samples) {
      EXPECT_NEAR(sample.u, middle(sample.row), 0.25) << on.name << ", row " << sample.row;
    }
  }
}

// The light that a sponge scatters is 15 pixels wide at half maximum.
TEST(FindLine, FindsTheMiddleOfLightThatScattersToOneSide) {
  const auto shares = [](double off) {
    constexpr std::array<double, 6> at{0, 5, 10, 20, 40, 60};
    constexpr std::array<double, 6> left{1, 0.67, 0.39, 0.25, 0.13, 0};
    constexpr std::array<double, 6> right{1, 0.61, 0.32, 0.14, 0.04, 0};
    for (std::size_t i = 1; i < at.size(); ++i) {
      if (std::abs(off) <= at[i]) {
        const auto& side = off < 0 ? left : right;
        return std::lerp(side[i - 1], side[i], (std::abs(off) - at[i - 1]) / (at[i] - at[i - 1]));
      }
    }
    return 0.0;
  };
  const auto middle = [](int v) { return 60.2 + 0.1 * v; };
  const Picture lit = draw([&](double u, int v) { return 200 * shares(u - middle(v)); });

  const std::vector<LineSample> samples = find_line(no_light, lit, {});

  ASSERT_EQ(samples.size(), static_cast<std::size_t>(height - 2));
  for (const LineSample& sample : samples) {
    EXPECT_NEAR(sample.u, middle(sample.row), 0.5) << "row " << sample.row;
  }
}

// A line that is white in its middle, on plaster.
TEST(FindLine, FindsASaturatedLineInItsHalo) {
  const Surface plaster{"plaster", 5, {0.18, 0.08, 0.03, 0.01}, {0.23, 0.08, 0.02, 0.01}};
  const auto middle = [](int v) { return 55.3 + 0.13 * v; };
  const Picture lit = draw([&](double u, int v) {
    const double off = u - middle(v);
    return line(off, 0, 330, plaster.width / 2.355) +
           200 * halo(off < 0 ? plaster.left : plaster.right, std::abs(off));
  });

  const std::vector<LineSample> samples = find_line(no_light, lit, {});

  ASSERT_EQ(samples.size(), static_cast<std::size_t>(height - 2));
  for (const LineSample& sample : samples) {
    EXPECT_NEAR(sample.u, middle(sample.row), 0.3) << "row " << sample.row;
  }
}

// Narrow reflections have more samples than the line, and are dimmer.
TEST(FindLine, JudgesWidthsByTheBrightestLine) {
  const Picture lit = draw([](double u, int) {
    double light = line(u, 60, 200, 5);
    for (const double place : {8, 20, 100, 112}) {
      light += line(u, place, 14, 1);
    }
    return light;
  });

  const std::vector<LineSample> samples = find_line(no_light, lit, {});

  const auto wide =
      std::ranges::count_if(samples, [](const auto& s) { return std::abs(s.u - 60) < 1; });
  EXPECT_EQ(wide, height - 2);
}

TEST(FindLine, FindsEveryPieceInARow) {
  const Picture lit = draw([](double u, int v) {
    return line(u, 30.5, 200) + (v > 10 && v < 50 ? line(u, 75.25, 40) : 0);
  });

  const std::vector<LineSample> samples = find_line(no_light, lit, {});

  const auto faint = std::ranges::count_if(samples, [](const auto& s) { return s.u > 60; });
  EXPECT_EQ(samples.size() - static_cast<std::size_t>(faint), static_cast<std::size_t>(height - 2));
  EXPECT_EQ(faint, 39 - 2);
}

TEST(FindLine, PartsTwoPiecesThatNearlyTouch) {
  const Picture lit = draw([](double u, int) { return line(u, 30, 180) + line(u, 37, 120); });

  const std::vector<LineSample> samples = find_line(no_light, lit, {});

  ASSERT_EQ(samples.size(), 2U * (height - 2));
  EXPECT_NEAR(samples[0].u, 30, 0.1);
  EXPECT_NEAR(samples[1].u, 37, 0.1);
}

TEST(FindLine, IsNotMovedByRoomLight) {
  const auto room = [](double u, int) { return u < 50 ? 30 : 90.0; };  // steps within the line
  const Picture dark = draw(room);
  const Picture lit = draw([&](double u, int v) { return room(u, v) + line(u, 50.4, 120); });

  const std::vector<LineSample> samples = find_line(dark, lit, {});

  ASSERT_EQ(samples.size(), static_cast<std::size_t>(height - 2));
  EXPECT_NEAR(samples[20].u, 50.4, 0.02);
}

TEST(FindLine, LeavesOutGlowAndSpecks) {
  const Picture lit = draw([](double u, int v) {
    const double glow = v > 30 ? line(u, 90, 120, 9) : 0;  // subsurface scattering
    const double speck = v == 7 || v == 8 ? line(u, 70, 200) : 0;
    return line(u, 30.5, 200) + glow + speck;
  });

  const std::vector<LineSample> samples = find_line(no_light, lit, {});

  EXPECT_EQ(samples.size(), static_cast<std::size_t>(height - 2));
  for (const LineSample& sample : samples) {
    EXPECT_NEAR(sample.u, 30.5, 0.1) << "row " << sample.row;
  }
}

TEST(FindLine, LeavesOutGlare) {
  const Picture lit = draw([](double u, int v) {
    return line(u, 30.5, 150) + (v > 20 && v < 40 && u > 60 && u < 72 ? 255 : 0);
  });

  const std::vector<LineSample> samples = find_line(no_light, lit, {});

  EXPECT_EQ(samples.size(), static_cast<std::size_t>(height - 2));
  for (const LineSample& sample : samples) {
    EXPECT_NEAR(sample.u, 30.5, 0.1) << "row " << sample.row;
  }
}

TEST(FindLine, LeavesOutTheRowsAtTheEndsOfAPiece) {
  const Picture lit =
      draw([](double u, int v) { return v >= 10 && v < 30 ? line(u, 50, 150) : 0; });

  const std::vector<LineSample> samples = find_line(no_light, lit, {.edge_rows = 2});

  ASSERT_FALSE(samples.empty());
  EXPECT_EQ(samples.front().row, 12);
  EXPECT_EQ(samples.back().row, 27);
}

TEST(FindLine, LinksEachSampleToTheNextRowOfItsPiece) {
  const Picture lit = draw([](double u, int v) {
    return line(u, v < 30 ? 40 : 70, 150);  // a step between two surfaces
  });

  const std::vector<LineSample> samples = find_line(no_light, lit, {});

  int ends = 0;
  for (const LineSample& sample : samples) {
    if (sample.next < 0) {
      ++ends;
      continue;
    }
    const LineSample& next = samples[static_cast<std::size_t>(sample.next)];
    EXPECT_EQ(next.row, sample.row + 1);
    EXPECT_NEAR(next.u, sample.u, 0.1);
  }
  EXPECT_EQ(ends, 2);
}

TEST(FindLine, AveragesSpeckleAlongTheLine) {
  Random random(3);
  std::vector<double> speckle;
  for (int i = 0; i < width * height; ++i) {
    speckle.push_back(std::max(0.0, 1 + 0.3 * random.normal()));
  }
  const auto middle = [](int v) { return 40 + 0.004 * v * v; };
  const Picture lit = draw([&](double u, int v) {
    return line(u, middle(v), 150) * speckle[static_cast<std::size_t>(v * width + std::lround(u))];
  });

  const auto rms = [&](int fit_rows) {
    double squares = 0;
    const std::vector<LineSample> samples = find_line(no_light, lit, {.fit_rows = fit_rows});
    EXPECT_GT(samples.size(), 50U);
    for (const LineSample& sample : samples) {
      squares += std::pow(static_cast<double>(sample.u) - middle(sample.row), 2);
    }
    return std::sqrt(squares / static_cast<double>(samples.size()));
  };
  // A quadratic fitted to 2 n + 1 = 9 columns has 0.51 times their noise in the middle; through 3
  // columns it has all of it.
  EXPECT_LT(rms(4), 0.7 * rms(1));
}

/// A picture in colour: each channel's share of a line's light, beside grey noise of 4 levels.
ColourPicture paint(const std::array<double, 3>& share, std::uint32_t seed) {
  Random random(seed);
  ColourPicture picture{.width = width, .height = height, .pixels = {}};
  for (int v = 0; v < height; ++v) {
    for (int u = 0; u < width; ++u) {
      Rgb pixel{};
      for (std::size_t channel = 0; channel < 3; ++channel) {
        const double level = 40 + 4 * random.normal() + share[channel] * line(u, 50, 90);
        pixel[channel] = static_cast<std::uint8_t>(std::clamp(std::lround(level), 0L, 255L));
      }
      picture.pixels.push_back(pixel);
    }
  }
  return picture;
}

TEST(FindChannel, TakesTheColourOfALaser) {
  const ColourPicture dark = paint({}, 1);
  EXPECT_EQ(find_channel(dark, paint({1, 0.05, 0.05}, 2)), Channel::red);
  EXPECT_EQ(find_channel(dark, paint({0.05, 0.1, 1}, 2)), Channel::blue);
}

// A camera has luminance at every pixel, and colours often at every second one.
TEST(FindChannel, TakesLuminanceWhereItHasHalfOfTheLight) {
  const ColourPicture dark = paint({}, 1);
  EXPECT_EQ(find_channel(dark, paint({1, 1, 1}, 2)), Channel::luminance);
  EXPECT_EQ(find_channel(dark, paint({0.2, 1, 0.2}, 2)), Channel::luminance);
  EXPECT_EQ(find_channel(dark, dark), Channel::luminance);
}

}  // namespace
}  // namespace octurn
