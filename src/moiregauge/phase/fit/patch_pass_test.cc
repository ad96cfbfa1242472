// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/phase/fit/patch_pass.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <random>

#include <gtest/gtest.h>

#include "moiregauge/phase/fit/simd_target.h"

namespace moiregauge::internal {
namespace {

constexpr int kPassSide = 150;

PatchModel oblique_model() {
  Matrix3 h;
  h << 0.033, 0.011, -3.1, 0.012, -0.034, 1.7, 2e-5, -4e-5, 1.0;
  PatchModel model{PrintFromImage(h), {{0.05, -0.1}, 1.9, 1.7}};
  model.light = {110.0, 3.0, -2.0};
  model.contrast = {1.1, 0.05, -0.02};
  model.gain = {0.9, 0.03, 0.01};
  return model;
}

PrintTemplate binary() {
  std::array<std::complex<double>, 11 * 11> series{};
  for (const int m : {-5, -3, -1, 1, 3, 5}) {
    for (const int n : {-5, -3, -1, 0, 1, 3, 5}) {
      const auto at = [](int x, int y) { return static_cast<std::size_t>((y + 5) * 11 + x + 5); };
      series[at(m, n)] = 20.0 / (std::abs(m) * std::max(1, std::abs(n)));
      if (n == 0) series[at(0, m)] = 20.0 / std::abs(m);
    }
  }
  return {5, series};
}

template <typename Grey>
Image<Grey> speckled(int most) {
  std::mt19937 rng(20261121);
  Image<Grey> picture(kPassSide, kPassSide);
  for (int y = 0; y < kPassSide; ++y) {
    for (Grey& grey : picture.row(y)) grey = static_cast<Grey>(rng() % static_cast<unsigned>(most));
  }
  return picture;
}

struct Summed {
  PatchSums sums, with_normal;
  NormalMatrix normal;
  ShiftSums shift;
  BlockSums blocks;
};

Summed summed(const LumaView& luma, int row_step) {
  Summed out;
  // The last block of a row reaches beyond the image.
  const PixelBox box{4, 6, kPassSide - 1, kPassSide - 2};
  out.sums = sum_patch(luma, oblique_model(), binary().nodes(), box);
  out.with_normal = sum_patch(luma, oblique_model(), binary().nodes(), box, &out.normal);
  out.shift = sum_shift(luma, oblique_model(), binary().nodes(), box, {row_step, row_step});
  out.blocks = sum_blocks(luma, oblique_model(), binary().nodes(), box, row_step);
  return out;
}

bool same(const PatchSums& a, const PatchSums& b) {
  return a.right == b.right && a.left2 == b.left2 && a.pixels == b.pixels;
}

TEST(PatchPass, GivesTheSameBitsOnEverySimdTarget) {
  const auto narrow = speckled<std::uint8_t>(256);
  const auto wide = speckled<std::uint16_t>(4096);
  for (const int row_step : {1, 3}) {
    std::optional<std::array<Summed, 2>> first;
    for (const std::string& target : simd_targets()) {
      ASSERT_TRUE(use_simd_target(target));
      const std::array now{summed(narrow.view(), row_step), summed(wide.view(), row_step)};
      if (!first) first = now;
      for (std::size_t k = 0; k < 2; ++k) {
        EXPECT_TRUE(same((*first)[k].sums, now[k].sums)) << target << " rows " << row_step;
        EXPECT_TRUE(same(now[k].sums, now[k].with_normal)) << target << " rows " << row_step;
        EXPECT_TRUE((*first)[k].normal == now[k].normal) << target << " rows " << row_step;
        EXPECT_TRUE((*first)[k].shift.right == now[k].shift.right && (*first)[k].shift.normal == now[k].shift.normal)
            << target << " rows " << row_step;
        EXPECT_EQ((*first)[k].blocks.squares, now[k].blocks.squares) << target;
        EXPECT_EQ((*first)[k].blocks.pixels, now[k].blocks.pixels) << target;
      }
    }
  }
  ASSERT_TRUE(use_simd_target(simd_targets().front()));
}

// Compares the sums with columns computed pixel by pixel in doubles.
TEST(PatchPass, SumsEqualAPixelByPixelComputation) {
  const auto picture = speckled<std::uint8_t>(256);
  const Summed seen = summed(picture.view(), 1);
  const PatchModel model = oblique_model();
  const PrintTemplate print = binary();
  const auto to_window = window_from_print(model.window);
  const auto plane = [](const PatchPlane& c, double u, double v) { return c[0] + c[1] * u + c[2] * v; };
  int pixels = 0;
  double left2 = 0.0;
  NormalVector right = NormalVector::Zero();
  NormalMatrix normal = NormalMatrix::Zero();
  BlockSums blocks;
  for (int y = 6; y <= kPassSide - 2; ++y) {
    for (int x = 4; x <= kPassSide - 1; ++x) {
      const PrintPoint p = model.map({double(x), double(y)});
      const auto at = to_window(p);
      const double u = at.x, v = at.y;
      if (std::abs(u) > 1.0 || std::abs(v) > 1.0) continue;
      const PrintLevel level = print.at(p);
      const double gain = plane(model.gain, u, v);
      NormalVector c;
      c << 1, u, v, level.t, level.t * u, level.t * v, gain * level.dxx, gain * level.dyy,
          gain * (level.dx * level.dx + level.dy * level.dy), NormalVector::Zero().head<18>();
      for (int k = 0; k < kFieldColumns; ++k) {
        const double power = std::pow(u, k % 3) * std::pow(v, k / 3);
        c(kBaseColumns + k) = gain * level.dx * power;
        c(kBaseColumns + kFieldColumns + k) = gain * level.dy * power;
      }
      const double left = picture.at(x, y) - plane(model.light, u, v) - plane(model.contrast, u, v) * level.t;
      const auto block_of = [](double uv) { return std::min(static_cast<int>((uv + 1.0) / 2.0 * kWindowBlocks), 5); };
      const auto block = static_cast<std::size_t>(block_of(v) * kWindowBlocks + block_of(u));
      ++blocks.pixels[block], blocks.squares[block] += left * left;
      ++pixels, left2 += left * left, right += left * c, normal += c * c.transpose();
    }
  }
  EXPECT_NEAR(seen.sums.pixels, pixels, 2.0) << "pixels on the window's very edge";
  EXPECT_NEAR(seen.sums.left2 / left2, 1.0, 1e-3);
  for (int i = 0; i < kColumns; ++i) {
    // A sum over random signs scatters by sqrt(sum left^2 c^2). A fiftieth of that is allowed.
    EXPECT_NEAR(seen.sums.right(i), right(i), 0.02 * std::sqrt(left2 * normal(i, i) / pixels)) << i;
    for (int j = 0; j <= i; ++j)
      EXPECT_NEAR(seen.normal(i, j), normal(i, j), 1e-3 * std::sqrt(normal(i, i) * normal(j, j))) << i << " " << j;
  }
  for (std::size_t b = 0; b < blocks.pixels.size(); ++b) {
    EXPECT_NEAR(seen.blocks.pixels[b], blocks.pixels[b], 2.0) << "pixels on a block's very edge " << b;
    // Such a pixel carries up to (255 levels)^2.
    EXPECT_NEAR(seen.blocks.squares[b], blocks.squares[b], 2.0 * 65025.0 + 1e-3 * blocks.squares[b]) << b;
  }
  // Shift of the whole window: the first columns of light, contrast and field.
  EXPECT_EQ(seen.shift.pixels, seen.sums.pixels);
  EXPECT_NEAR(seen.shift.left2 / left2, 1.0, 1e-3);
  constexpr std::array<int, kShiftColumns> kOf{0, 3, kBaseColumns, kBaseColumns + kFieldColumns};
  for (int i = 0; i < kShiftColumns; ++i) {
    const int a = kOf[static_cast<std::size_t>(i)];
    EXPECT_NEAR(seen.shift.right(i), right(a), 0.02 * std::sqrt(left2 * normal(a, a) / pixels)) << i;
    for (int j = 0; j < kShiftColumns; ++j) {
      const int b = kOf[static_cast<std::size_t>(j)];
      EXPECT_NEAR(seen.shift.normal(i, j), normal(a, b), 1e-3 * std::sqrt(normal(a, a) * normal(b, b)))
          << i << " " << j;
    }
  }
}

}  // namespace
}  // namespace moiregauge::internal
