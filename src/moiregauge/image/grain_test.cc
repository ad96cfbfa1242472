// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/image/grain.h"

#include <cmath>
#include <functional>
#include <random>
#include <vector>

#include <gtest/gtest.h>

namespace moiregauge::internal {
namespace {

constexpr int kSide = 256, kFrames = 40;
constexpr double kSigma = 1.5;  // grey levels
using Plane = std::vector<double>;

// Blurred edges, one every 38 px, that move by `shift` px, in light `gain`.
Plane scene(double shift, double gain) {
  Plane plane;
  for (int y = 0; y < kSide; ++y) {
    for (int x = 0; x < kSide; ++x)
      plane.push_back(gain * (120.0 + 80.0 * std::tanh(4.0 * std::sin((x - shift) / 12.0))));
  }
  return plane;
}

// Makes the camera's frame from the sensor's, and from the last frame of the camera.
using Process = std::function<Plane(const Plane& sensor, const Plane& last)>;

GrainSums sums_of(const Process& process, double movement_px, double flicker, bool is_still = true,
                  bool is_lossless = true) {
  std::vector<PixelPosition> tiles;
  for (int y = 0; y + kGrainTile <= kSide; y += 16) {
    for (int x = 0; x + kGrainTile <= kSide; x += 16) tiles.push_back({x, y});
  }
  GrainSampler sampler(tiles);
  std::mt19937 random(7);
  std::normal_distribution<double> grain(0.0, kSigma);
  Plane last;
  for (int n = 0; n < kFrames; ++n) {
    Plane sensor =
        scene(is_still ? movement_px * std::sin(0.9 * n) : movement_px * n, 1.0 + flicker * std::cos(1.7 * n));
    for (double& grey : sensor) grey += grain(random);
    last = last.empty() ? sensor : process(sensor, last);
    Image<std::uint8_t> stored(kSide, kSide);
    for (int y = 0; y < kSide; ++y) {
      for (int x = 0; x < kSide; ++x)
        stored.at(x, y) = static_cast<std::uint8_t>(std::lround(last[static_cast<std::size_t>(y * kSide + x)]));
    }
    sampler.add(stored.view(), 255, {.is_still = is_still, .is_lossless = is_lossless});
  }
  return is_still ? sampler.still() : sampler.moving();
}

const Process kAsItIs = [](const Plane& sensor, const Plane&) { return sensor; };

// The variance of a ratio of sums over n values is below 2 / n. With n = 250 000, 4 u is 0.011.
TEST(Grain, IsIndependentInASensorWithMovementAndFlicker) {
  for (const double movement_px : {0.0, 0.02, 0.08}) {
    for (const double flicker : {0.0, 0.02}) {
      const GrainSums sums = sums_of(kAsItIs, movement_px, flicker);
      ASSERT_GT(sums.values, 200000);
      EXPECT_NEAR(sums.one_apart / sums.two_apart, 1.0, 0.02) << movement_px << " px, flicker " << flicker;
    }
  }
  const GrainSums still = sums_of(kAsItIs, 0.0, 0.0);
  EXPECT_NEAR(still.two_apart / still.values, 2.0 * (kSigma * kSigma + 1.0 / 12.0), 0.05);
}

TEST(Grain, IsCorrelatedByTheShareOfARecursiveFilter) {
  for (const double share : {0.1, 0.3, 0.6}) {
    const Process recursive = [share](const Plane& sensor, const Plane& last) {
      Plane out(sensor);
      for (std::size_t i = 0; i < out.size(); ++i) out[i] = (1.0 - share) * sensor[i] + share * last[i];
      return out;
    };
    const GrainSums sums = sums_of(recursive, 0.0, 0.0);
    // Rounding to whole grey levels adds an independent variance of 1 / 12.
    const double filtered = kSigma * kSigma * (1.0 - share) / (1.0 + share), rounding = 1.0 / 12.0;
    const double ratio = (filtered * (1.0 - share) + rounding) / (filtered * (1.0 - share * share) + rounding);
    EXPECT_NEAR(sums.one_apart / sums.two_apart, ratio, 0.02) << share;
  }
}

// A paper with lines comes before a corner of the scene, and leaves it: two steps in 40 frames, in a twentieth of the
// tiles. A step of the squared height h^2 adds h^2 / 2 to frames one apart and h^2 to those two apart.
TEST(Grain, IsIndependentInTilesThatAreCoveredAndUncovered) {
  int frame = 0;
  const Process cover = [&frame](const Plane& sensor, const Plane&) {
    Plane out(sensor);
    ++frame;
    for (int y = 0; y < 64 && frame > 12 && frame < 26; ++y) {
      for (int x = 0; x < 48; ++x) out[static_cast<std::size_t>(y * kSide + x)] += 40.0 * std::sin(0.7 * y);
    }
    return out;
  };
  const GrainSums covered = sums_of(cover, 0.0, 0.0);
  EXPECT_NEAR(covered.one_apart / covered.two_apart, 1.0, 0.02);
  frame = 0;
  const GrainSums behind_codec = sums_of(cover, 0.0, 0.0, true, false);
  EXPECT_LT(behind_codec.one_apart / behind_codec.two_apart, 0.97);  // nothing is excluded
}

// Flat tiles between the edges of a moving scene.
TEST(Grain, IsSeenInFlatTilesOfASceneThatMoves) {
  const Process recursive = [](const Plane& now, const Plane& last) {
    Plane out(now);
    for (std::size_t i = 0; i < out.size(); ++i) out[i] = 0.6 * now[i] + 0.4 * last[i];
    return out;
  };
  for (const double movement_px : {0.5, 2.0}) {
    const GrainSums sensor = sums_of(kAsItIs, movement_px, 0.0, false);
    ASSERT_GT(sensor.values, 20000);  // 4 u of the ratio: 0.04
    EXPECT_NEAR(sensor.one_apart / sensor.two_apart, 1.0, 0.04) << movement_px;
    const GrainSums filtered = sums_of(recursive, movement_px, 0.0, false);
    EXPECT_LT(filtered.one_apart / filtered.two_apart, 0.82) << movement_px;
  }
}

// An edge that moves changes grey levels more in two frames than in one. The ratio is 1/4 for small movements, and 1/2
// where the edge leaves its blur. So tiles count only where the ink is uniform in all three frames.
TEST(Grain, IsNotTakenFromTilesThatAnEdgeEnters) {
  GrainSampler sampler({{0, 0}}), informed({{0, 0}, {8, 0}});
  std::mt19937 random(7);
  std::normal_distribution<double> grain(0.0, kSigma);
  constexpr int kEdgeFrames = 12;
  for (int n = 0; n < kEdgeFrames; ++n) {
    Image<std::uint8_t> frame(16, 8);
    for (int y = 0; y < 8; ++y) {
      for (int x = 0; x < 16; ++x) {
        const double edge = 60.0 * std::tanh(x - 0.5 * n);  // within the first tile
        frame.at(x, y) = static_cast<std::uint8_t>(std::lround(120.0 + edge + grain(random)));
      }
    }
    sampler.add(frame.view(), 255, {.is_lossless = true});
    informed.add(frame.view(), 255, {.is_lossless = true, .is_uniform = {false, n != 6}});
  }
  EXPECT_LT(sampler.moving().one_apart, 0.6 * sampler.moving().two_apart);
  // Ten triples of frames, without the three that contain frame 6. 21 independent values per tile.
  EXPECT_NEAR(informed.moving().values, 7 * 21.3, 1.0);
}

TEST(Grain, ClippedTilesAreExcluded) {
  Image<std::uint8_t> white(kSide, kSide, 255);
  GrainSampler sampler({{0, 0}, {8, 8}});
  for (int n = 0; n < 4; ++n) sampler.add(white.view(), 255, {.is_still = true});
  EXPECT_EQ(sampler.still().values, 0.0);
}

}  // namespace
}  // namespace moiregauge::internal
