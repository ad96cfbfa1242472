// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/phase/patch_pass.h"

#include <cmath>
#include <cstring>
#include <optional>
#include <random>

#include <gtest/gtest.h>

#include "moiregauge/phase/simd_target.h"

namespace moiregauge {
namespace {

constexpr int kSide = 150;

PatchMap oblique() {
  Matrix3 h;
  h << 0.033, 0.011, -3.1, 0.012, -0.034, 1.7, 2e-5, -4e-5, 1.0;
  PatchMap map{PrintFromImage(h), 74.3, 75.1, 52.0};
  map.dx = {0.01, 0.002, -0.001, 0.003, 0.0, 0.001, -0.002, 0.0, 0.0005};
  map.dy = {-0.02, 0.001, 0.002, -0.001, 0.001, 0.0, 0.001, 0.0002, 0.0};
  map.light = {110.0, 3.0, -2.0};
  map.contrast = map.gain = {1.1, 0.05, -0.02};
  return map;
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
  Image<Grey> picture(kSide, kSide);
  for (int y = 0; y < kSide; ++y) {
    for (Grey& grey : picture.row(y)) grey = static_cast<Grey>(rng() % static_cast<unsigned>(most));
  }
  return picture;
}

PatchSums summed(const LumaView& luma, int row_step) {
  PatchSums sums;
  // The last block of a row reaches beyond the picture.
  sum_patch(luma, oblique(), {{0.05, -0.1}, 1.9, 1.7}, binary().nodes(), {4, 6, kSide - 1, kSide - 2}, row_step, sums);
  return sums;
}

TEST(PatchPass, GivesTheSameBitsOnEverySimdTarget) {
  const auto narrow = speckled<std::uint8_t>(256);
  const auto wide = speckled<std::uint16_t>(4096);
  for (const int row_step : {1, 3}) {
    std::optional<std::array<PatchSums, 2>> first;
    for (const std::string& target : simd_targets()) {
      ASSERT_TRUE(use_simd_target(target));
      const std::array now{summed(narrow.view(), row_step), summed(wide.view(), row_step)};
      if (!first) first = now;
      for (std::size_t k = 0; k < 2; ++k)
        EXPECT_EQ(std::memcmp(&(*first)[k], &now[k], sizeof now[k]), 0) << target << " rows " << row_step;
    }
  }
  ASSERT_TRUE(use_simd_target(simd_targets().front()));
}

// Against the sums written down pixel by pixel, the place of each exact: lanes of 24 bits, up to four rows of one v.
TEST(PatchPass, SumsWhatItSaysItSums) {
  const auto picture = speckled<std::uint8_t>(256);
  const PatchSums sums = summed(picture.view(), 1);
  const PatchMap map = oblique();
  const PrintTemplate print = binary();
  double pixels = 0.0, left2 = 0.0, left_tx = 0.0, left_tx_u2v = 0.0, tx2 = 0.0;
  for (int y = 6; y <= kSide - 2; ++y) {
    for (int x = 4; x <= kSide - 1; ++x) {
      const double u = (x - map.x0) / map.scale, v = (y - map.y0) / map.scale;
      PrintPoint p = map.map({double(x), double(y)});
      for (std::size_t k = 0; k < kFieldColumns; ++k) {
        const double power = std::pow(u, double(k % 3)) * std::pow(v, double(k / 3));
        p = {p.x + map.dx[k] * power, p.y + map.dy[k] * power};
      }
      if (std::abs(p.x - 0.05) > 1.9 || std::abs(p.y + 0.1) > 1.7) continue;
      const PrintLevel level = print.at(p);
      const double gain = map.gain[0] + map.gain[1] * u + map.gain[2] * v;
      const double left = picture.at(x, y) - (map.light[0] + map.light[1] * u + map.light[2] * v) - gain * level.t;
      const double tx = gain * level.dx;
      pixels += 1.0, left2 += left * left, left_tx += left * tx, left_tx_u2v += left * tx * u * u * v, tx2 += tx * tx;
    }
  }
  EXPECT_NEAR(sums.pixels(), pixels, 2.0) << "pixels on the window's very edge";
  EXPECT_NEAR(sums.moment(PatchProduct::kGrey2, 0, 0) / left2, 1.0, 1e-3);
  EXPECT_NEAR(sums.moment(PatchProduct::kTx2, 0, 0) / tx2, 1.0, 1e-3);
  // Of sums over random signs: a thousandth of their own scatter, sqrt(sum left^2 tx^2).
  const double scatter = std::sqrt(left2 * tx2 / pixels);
  EXPECT_NEAR(sums.moment(PatchProduct::kGTx, 0, 0), left_tx, 0.02 * scatter);
  EXPECT_NEAR(sums.moment(PatchProduct::kGTx, 2, 1), left_tx_u2v, 0.02 * scatter);
}

}  // namespace
}  // namespace moiregauge
