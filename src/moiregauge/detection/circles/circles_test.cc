// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/detection/circles/circles.h"

#include <algorithm>
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "moiregauge/detection/circles/rendered_disc_for_tests.h"

namespace moiregauge::internal {
namespace {

using test::coverage;
using test::Disc;
using test::grey_levels;
using test::picture;
using test::Scene;

constexpr std::uint64_t kCirclesSeed = 20240611;
constexpr double kCentreGoal = 0.005;  // px, largest error of the centre without noise (chosen)

CircleSearch search_of(const Disc& disc, const Scene& scene) {
  std::mt19937_64 rng(kCirclesSeed);
  const auto image = picture<std::uint16_t>(grey_levels(coverage(disc, scene), scene), scene.size, 64.0, 0.0, rng);
  return find_circles(LumaView(image.view()), {});
}

TEST(CircleCentre, IsTheCentreOfTheImagedEllipseAtEveryTiltAndSize) {
  for (const double tilt : {0.0, 8.0, 20.0, 40.0}) {
    for (const double diameter : {15.0, 30.0, 60.0}) {
      const Disc disc{63.31, 64.78, diameter, radians_from_degrees(tilt), 0.6};
      const CircleSearch search = search_of(disc, {});
      ASSERT_EQ(search.circles.size(), 1U) << tilt << " deg, " << diameter << " px";
      const DetectedCircle& seen = search.circles.front();
      EXPECT_LT(std::hypot(seen.centre.x - disc.x, seen.centre.y - disc.y), kCentreGoal)
          << tilt << " deg, " << diameter;
      EXPECT_NEAR(seen.axis_ratio, std::cos(disc.tilt_rad), 0.005);
      EXPECT_NEAR(seen.diameter_px, diameter * std::sqrt(std::cos(disc.tilt_rad)), 0.1);
    }
  }
}

TEST(CircleCentre, DoesNotMoveWhenTheLightComesFromOneSide) {
  const Disc disc{64.2, 63.6, 40.0, 0.3, 1.0};
  Scene scene;
  scene.shading = 0.6;
  const CircleSearch search = search_of(disc, scene);
  ASSERT_EQ(search.circles.size(), 1U);
  EXPECT_LT(std::hypot(search.circles[0].centre.x - disc.x, search.circles[0].centre.y - disc.y), kCentreGoal);
}

TEST(CircleCentre, IsTheSameForALightDiscOnDarkPaper) {
  const Disc disc{64.2, 63.6, 25.0, 0.3, 1.0};
  Scene scene;
  std::swap(scene.paper, scene.ink);
  const CircleSearch search = search_of(disc, scene);
  ASSERT_EQ(search.circles.size(), 1U);
  EXPECT_LT(std::hypot(search.circles[0].centre.x - disc.x, search.circles[0].centre.y - disc.y), kCentreGoal);
  EXPECT_NEAR(search.circles[0].contrast, scene.ink - scene.paper, 0.02 * 64.0 * 130.0 + 64.0 * 130.0);
  EXPECT_GT(search.circles[0].contrast, 0.0);
}

TEST(CircleCentre, ScattersUnderNoiseAsMuchAsItsStandardUncertaintySays) {
  constexpr int kTrials = 200;
  for (const double diameter : {12.0, 40.0}) {
    const Disc disc{64.3, 63.8, diameter, 0.35, 0.4};
    const Scene scene;
    const auto levels = grey_levels(coverage(disc, scene), scene);
    std::mt19937_64 rng(kCirclesSeed);
    double squares = 0.0, stated = 0.0;
    for (int i = 0; i < kTrials; ++i) {
      const auto image = picture<std::uint8_t>(levels, scene.size, 1.0, 3.0, rng);
      const auto circles = find_circles(LumaView(image.view()), {}).circles;
      ASSERT_EQ(circles.size(), 1U) << "seed " << kCirclesSeed << " trial " << i;
      squares += std::pow(circles[0].centre.x - disc.x, 2) + std::pow(circles[0].centre.y - disc.y, 2);
      stated += std::pow(circles[0].u_centre_px, 2);
    }
    // The ratio has a relative standard error of 1 / sqrt(4 n), for two coordinates per trial. The limit is 4 of these,
    // plus 5 % for the model of the fit.
    EXPECT_NEAR(std::sqrt(squares / 2.0 / stated), 1.0, 0.05 + 4.0 / std::sqrt(4.0 * kTrials))
        << "seed " << kCirclesSeed;
  }
}

TEST(CircleCentre, IsTheSameInTheWholeImageAndNearAPrediction) {
  const Disc disc{64.3, 63.8, 40.0, 0.35, 0.4};
  std::mt19937_64 rng(kCirclesSeed);
  const auto image = picture<std::uint8_t>(grey_levels(coverage(disc, {}), {}), 128, 1.0, 2.0, rng);
  const auto everywhere = find_circles(LumaView(image.view()), {}).circles;
  const auto near = find_circles_near(LumaView(image.view()), {68.0, 60.0}, 38.0, 10.0, {});
  ASSERT_EQ(everywhere.size(), 1U);
  ASSERT_EQ(near.size(), 1U);
  EXPECT_LT(length(near[0].centre - everywhere[0].centre), 0.02 * everywhere[0].u_centre_px);
  EXPECT_TRUE(find_circles_near(LumaView(image.view()), {90.0, 60.0}, 38.0, 10.0, {}).empty());
}

TEST(Circularity, IsThatOfTheTrueEllipseNotOfItsPixels) {
  for (const double tilt : {0.0, 20.0, 40.0}) {
    const CircleSearch search = search_of({63.4, 64.1, 24.0, radians_from_degrees(tilt), 0.7}, {});
    ASSERT_EQ(search.circles.size(), 1U);
    // Ramanujan's perimeter of the ellipse with half axes 1 and b.
    const double b = std::cos(radians_from_degrees(tilt)), h = std::pow((1.0 - b) / (1.0 + b), 2);
    const double perimeter = kPi * (1.0 + b) * (1.0 + 3.0 * h / (10.0 + std::sqrt(4.0 - 3.0 * h)));
    EXPECT_NEAR(search.circles[0].circularity, 4.0 * kPi * kPi * b / (perimeter * perimeter), 0.01);
  }
}

TEST(Circularity, SquaresAreNotCirclesAtAnyRotationAndSize) {
  std::mt19937_64 rng(kCirclesSeed);
  for (const double side : {8.0, 12.0, 25.0, 50.0}) {
    for (double turn = 0.0; turn < 1.6; turn += 0.2) {
      Scene scene;
      std::vector<double> share(128 * 128, 0.0);
      for (std::size_t i = 0; i < share.size(); ++i) {
        const double x = static_cast<double>(i % 128) - 63.7, y = static_cast<double>(i / 128) - 64.2;
        const double u = std::cos(turn) * x + std::sin(turn) * y, v = std::cos(turn) * y - std::sin(turn) * x;
        share[i] = (test::beyond_edge(u + 0.5 * side, 0.7) - test::beyond_edge(u - 0.5 * side, 0.7)) *
                   (test::beyond_edge(v + 0.5 * side, 0.7) - test::beyond_edge(v - 0.5 * side, 0.7));
      }
      const auto image = picture<std::uint8_t>(grey_levels(share, scene), 128, 1.0, 1.5, rng);
      EXPECT_TRUE(find_circles(LumaView(image.view()), {}).circles.empty()) << side << " px turned " << turn << " rad";
    }
  }
}

TEST(FindCircles, ADiscInsideARingIsFoundAndSoAreTheRingsTwoEdges) {
  const Scene scene;
  auto share = coverage({64.0, 64.0, 90.0, 0.2, 0.3}, scene);
  const auto hole = coverage({64.0, 64.0, 60.0, 0.2, 0.3}, scene), disc = coverage({64.3, 63.9, 30.0, 0.2, 0.3}, scene);
  for (std::size_t i = 0; i < share.size(); ++i) share[i] += disc[i] - hole[i];
  std::mt19937_64 rng(kCirclesSeed);
  const auto image = picture<std::uint16_t>(grey_levels(share, scene), scene.size, 16.0, 0.0, rng);
  auto circles = find_circles(LumaView(image.view()), {}).circles;
  ASSERT_EQ(circles.size(), 3U);
  std::sort(circles.begin(), circles.end(), [](const auto& a, const auto& b) { return a.diameter_px < b.diameter_px; });
  EXPECT_LT(std::hypot(circles[0].centre.x - 64.3, circles[0].centre.y - 63.9), kCentreGoal);
}

// A small disc must be found at any position relative to the tiles and scales of the search. The search near a
// prediction must give the same centre.
TEST(FindCircles, ASmallDiscIsFoundAtEveryPositionOfALargeImage) {
  constexpr int kPlaces = 6;  // per axis, 1.17 px apart: covers a tile of 4 px at different fractions of a pixel
  for (const bool light_disc : {false, true}) {
    for (int i = 0; i < kPlaces * kPlaces; ++i) {
      Scene scene;
      if (light_disc) std::swap(scene.paper, scene.ink);
      const Disc disc{63.1 + 1.17 * (i % kPlaces), 62.9 + 1.17 * (i / kPlaces), 9.0, 0.2, 0.5};
      std::mt19937_64 rng(kCirclesSeed + static_cast<std::uint64_t>(i));
      const auto speck = picture<std::uint8_t>(grey_levels(coverage(disc, scene), scene), scene.size, 1.0, 1.0, rng);
      Image<std::uint8_t> sheet(901, 403, static_cast<std::uint8_t>(scene.paper));
      const int x0 = 530 + i % 5, y0 = 170 + i % 7;
      for (int y = 0; y < scene.size; ++y) std::ranges::copy(speck.view().row(y), sheet.row(y0 + y).begin() + x0);
      const auto circles = find_circles(LumaView(sheet.view()), {}).circles;
      ASSERT_EQ(circles.size(), 1U) << disc.x << ", " << disc.y << " seed "
                                    << kCirclesSeed + static_cast<std::uint64_t>(i);
      const ImagePoint centre{x0 + disc.x, y0 + disc.y};
      EXPECT_LT(length(circles[0].centre - centre), 4.0 * circles[0].u_centre_px + kCentreGoal);
      const auto near = find_circles_near(LumaView(sheet.view()), centre, 9.0, 5.0, {});
      ASSERT_EQ(near.size(), 1U);
      EXPECT_LT(length(near[0].centre - circles[0].centre), 0.05 * circles[0].u_centre_px);
    }
  }
}

TEST(FindCircles, ADiscCutOffByTheEdgeOfTheImageIsNotReported) {
  EXPECT_TRUE(search_of({3.0, 64.0, 30.0, 0.0, 0.0}, {}).circles.empty());
}

TEST(FindCircles, AnEmptyNoisyImageHasNoCircles) {
  std::mt19937_64 rng(kCirclesSeed);
  const auto image = picture<std::uint8_t>(std::vector<double>(128 * 128, 120.0), 128, 1.0, 3.0, rng);
  EXPECT_TRUE(find_circles(LumaView(image.view()), {}).circles.empty()) << "seed " << kCirclesSeed;
}

}  // namespace
}  // namespace moiregauge::internal
