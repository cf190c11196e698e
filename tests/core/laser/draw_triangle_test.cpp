#include "laser/draw_triangle.hpp"

#include <gtest/gtest.h>

#include <set>
#include <utility>
#include <vector>

namespace octurn {
namespace {

using Pixels = std::set<std::pair<int, int>>;

constexpr int width = 8;
constexpr int height = 6;

Pixels pixels_of(const std::array<ImageCorner, 3>& corners) {
  Pixels pixels;
  visit_pixels(corners, width, height, [&](int u, int v, const std::array<double, 3>& /*shares*/) {
    pixels.emplace(u, v);
  });
  return pixels;
}

TEST(VisitPixels, VisitsThoseWhoseCentresLieInTheTriangle) {
  EXPECT_EQ(pixels_of({ImageCorner{.u = 1, .v = 1}, {.u = 3, .v = 1}, {.u = 1, .v = 3}}),
            (Pixels{{1, 1}, {2, 1}, {3, 1}, {1, 2}, {2, 2}, {1, 3}}));
}

TEST(VisitPixels, VisitsNoneOfATriangleBesideTheImageHoweverFar) {
  for (const double far : {100.0, 1e12, 1e300}) {
    for (const double u : {-far, 0.0, far}) {
      for (const double v : {-far, 0.0, far}) {
        if (u != 0 || v != 0) {
          EXPECT_EQ(pixels_of({ImageCorner{.u = u, .v = v},
                               {.u = u + far / 8, .v = v},
                               {.u = u, .v = v + far / 8}}),
                    Pixels{})
              << u << ' ' << v;
        }
      }
    }
  }
}

TEST(VisitPixels, VisitsTheWholeImageInATriangleThatReachesFarBeyondIt) {
  const double far = 1e12;
  EXPECT_EQ(
      pixels_of({ImageCorner{.u = -far, .v = -far}, {.u = far, .v = -far}, {.u = 0, .v = far}})
          .size(),
      std::size_t{width} * height);
}

}  // namespace
}  // namespace octurn
