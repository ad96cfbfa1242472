// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/detection/circles/radial_profile.h"

#include <algorithm>
#include <array>
#include <random>

#include <gtest/gtest.h>

#include "moiregauge/phase/fit/simd_target.h"

namespace moiregauge::internal::markers_detail {
namespace {

constexpr std::uint64_t kRaySeed = 20240611;
constexpr int kSide = 40;
using Profile = std::array<double, 40>;

template <typename Grey>
Image<Grey> speckled(unsigned levels) {
  std::mt19937_64 rng(kRaySeed);
  Image<Grey> out(kSide, kSide);
  for (int y = 0; y < kSide; ++y) {
    for (Grey& grey : out.row(y)) grey = static_cast<Grey>(rng() % levels);
  }
  return out;
}

template <typename Grey>
double bilinear(const Image<Grey>& picture, double x, double y) {
  const int ix = std::min(static_cast<int>(x), kSide - 2), iy = std::min(static_cast<int>(y), kSide - 2);
  const double fx = x - ix, fy = y - iy;
  const double top = picture.at(ix, iy) + fx * (picture.at(ix + 1, iy) - picture.at(ix, iy));
  const double low = picture.at(ix, iy + 1) + fx * (picture.at(ix + 1, iy + 1) - picture.at(ix, iy + 1));
  return top + fy * (low - top);
}

template <typename Grey>
void expect_definition(const Image<Grey>& picture, const RaySteps& ray) {
  for (const std::string& target : simd_targets()) {
    ASSERT_TRUE(use_simd_target(target));
    Profile profile{};
    sample_ray(picture.view(), ray, profile.data());
    for (int j = 0; j < ray.samples; ++j) {
      const double along = ray.first + ray.step * j;
      EXPECT_EQ(profile[static_cast<std::size_t>(j)], bilinear(picture, ray.x + along * ray.dx, ray.y + along * ray.dy))
          << target << " sample " << j << " of " << ray.samples;
    }
  }
  ASSERT_TRUE(use_simd_target(simd_targets().front()));
}

// The second ray reaches the last row and column of pixels.
TEST(RayProfile, IsBilinearToTheLastBitOnEverySimdTarget) {
  for (int samples = 2; samples <= 25; ++samples) {
    const RaySteps oblique{20.3, 19.1, 0.6, -0.8, -3.7, 0.5, samples},
        to_the_corner{39.0, 39.0, -1.0, 0.0, 0.0, 0.5, samples};
    expect_definition(speckled<std::uint8_t>(256), oblique);
    expect_definition(speckled<std::uint8_t>(256), to_the_corner);
    expect_definition(speckled<std::uint16_t>(65536), oblique);
    expect_definition(speckled<std::uint16_t>(65536), to_the_corner);
  }
}

TEST(RayProfile, RisesWhereItCrossesTheLevelFromBelow) {
  std::mt19937_64 rng(kRaySeed);
  for (int samples = 2; samples <= 25; ++samples) {
    Profile profile{};
    for (double& grey : profile) grey = static_cast<double>(rng() % 5);  // often equal to the level
    for (const double sign : {1.0, -1.0}) {
      std::uint32_t truth = 0;
      for (int j = 0; j + 1 < samples; ++j) {
        const auto i = static_cast<std::size_t>(j);
        if (sign * (profile[i] - 2.0) < 0.0 && sign * (profile[i + 1] - 2.0) >= 0.0) truth |= 1U << j;
      }
      for (const std::string& target : simd_targets()) {
        ASSERT_TRUE(use_simd_target(target));
        EXPECT_EQ(rises(profile.data(), samples, 2.0, sign), truth) << target << ' ' << samples;
      }
    }
  }
  ASSERT_TRUE(use_simd_target(simd_targets().front()));
}

TEST(RayProfile, MedianIsTheMiddleOfTheSortedOnEverySimdTarget) {
  std::mt19937_64 rng(kRaySeed);
  for (int count = 1; count <= 40; ++count) {
    Profile values{};
    for (double& value : values) value = static_cast<double>(rng() % 20) - 10.0;  // some of them equal
    Profile sorted = values;
    std::sort(sorted.begin(), sorted.begin() + count);
    for (const std::string& target : simd_targets()) {
      ASSERT_TRUE(use_simd_target(target));
      EXPECT_EQ(median(values.data(), count), sorted[static_cast<std::size_t>(count / 2)]) << target << ' ' << count;
    }
  }
  ASSERT_TRUE(use_simd_target(simd_targets().front()));
}

}  // namespace
}  // namespace moiregauge::internal::markers_detail
