// SPDX-License-Identifier: Apache-2.0
// How far has a grating moved between two pictures? Two arrays of grey levels, made here with a known shift and camera
// noise, are measured by sampling moire; the answer comes with its standard uncertainty.
#include <cmath>
#include <cstdio>
#include <random>

#include <moiregauge/phase/sampling_moire/sampling_moire.h>
#include <moiregauge/units/units.h>
#include <moiregauge/version.h>

namespace {

using moiregauge::Image;

constexpr double kPitchMm = 10.0, kPitchPx = 29.3, kNoise = 1.5, kAmplitude = 85.0;
constexpr int kSide = 240, kRegion = 160;

// A cosine grating across x, moved to the right by shift_mm.
Image<double> photographed(double shift_mm, std::mt19937_64& dice) {
  std::normal_distribution<double> noise(0.0, kNoise);
  Image<double> picture(kSide, kSide);
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x)
      picture.at(x, y) =
          125.0 + kAmplitude * std::cos(moiregauge::kTurn * (x / kPitchPx - shift_mm / kPitchMm)) + noise(dice);
  return picture;
}

}  // namespace

int main() {
  std::mt19937_64 dice(1);
  const double true_mm = 0.25;
  const auto before = photographed(0.0, dice), after = photographed(true_mm, dice);
  const moiregauge::Sampling sampling{std::round(kPitchPx), kPitchPx, kRegion};
  const auto first = moiregauge::measure_region(before.view(), moiregauge::Axis::kX, sampling);
  const auto second = moiregauge::measure_region(after.view(), moiregauge::Axis::kX, sampling);
  if (!first.valid || !second.valid) {
    std::fprintf(stderr, "error: no grating to be seen: the pictures: make them brighter\n");
    return 1;
  }
  // A grating that moves to the right lowers the phase at a fixed pixel.
  const double turn = std::remainder(second.phase_rad - first.phase_rad, moiregauge::kTurn) / moiregauge::kTurn;
  const double moved_mm = -turn * kPitchMm;
  const double u_rad =
      moiregauge::region_mean_uncertainty(kNoise, first.modulation, sampling.sampling_pitch_px, kPitchPx, kRegion);
  const double u_mm = std::sqrt(2.0) * u_rad / moiregauge::kTurn * kPitchMm;  // both pictures have noise
  std::printf("moiregauge %s: moved %.5f mm, u = %.5f mm, truth %.5f mm\n", moiregauge::kVersion, moved_mm, u_mm,
              true_mm);
  return std::abs(moved_mm - true_mm) < 5.0 * u_mm ? 0 : 1;
}
