// SPDX-License-Identifier: Apache-2.0
// Measures the shift of one grating patch between two images, with its uncertainty. Links moiregauge::sampling_moire only.
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <random>
#include <vector>

#include <moiregauge/sampling_moire.h>

namespace {

constexpr double kPitchPx = 29.3, kNoise = 1.5;
constexpr int kSide = 240, kRegion = 160;

std::vector<std::uint8_t> photograph(double shift_px, std::mt19937_64& dice) {
  std::normal_distribution<double> noise(0.0, kNoise);
  std::vector<std::uint8_t> pixels;
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x)
      pixels.push_back(static_cast<std::uint8_t>(
          std::lround(125.0 + 85.0 * std::cos(2.0 * M_PI * (x - shift_px) / kPitchPx) + noise(dice))));
  return pixels;
}

}  // namespace

int main() {
  std::mt19937_64 dice(1);
  const double true_px = 0.733;
  const auto before = photograph(0.0, dice), after = photograph(true_px, dice);
  const auto first =
      moiregauge::sampling_moire({before.data(), kSide, kSide}, moiregauge::Axis::kX, kPitchPx, kRegion, kNoise);
  const auto second =
      moiregauge::sampling_moire({after.data(), kSide, kSide}, moiregauge::Axis::kX, kPitchPx, kRegion, kNoise);
  if (!first.is_valid || !second.is_valid) return 1;
  const double moved = moiregauge::displacement_px(first, second, kPitchPx);
  const double u = std::hypot(first.u_rad, second.u_rad) / (2.0 * M_PI) * kPitchPx;
  std::printf("moved %.5f px, u = %.5f px, truth %.5f px\n", moved, u, true_px);
  return std::abs(moved - true_px) < 5.0 * u ? 0 : 1;
}
