// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/observation/print/pixel_locking.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "moiregauge/units/units.h"

namespace moiregauge::internal {
namespace {

// Fewer orders do not show how the harmonics fall.
constexpr int kMinOrder = 6;
// Share of the sum of magnitudes that lines of the worst width have. Their two edges differ in phase by the width, which
// leaves half of the product of two orders.
constexpr double kWorstLine = 0.5;
// Amplitude that other parts of u cover, px. A PSF of 0.7 px leaves 0.001 px.
constexpr double kCovered_px = 0.002;

double square_of(double v) { return v * v; }

// Returns m^2 |c|^2 for the orders m = 1, 2, ... along one axis, summed over those of the other axis.
std::vector<double> slope_powers(const PrintTemplate& print, int axis, double noise_variance) {
  const int order = print.order();
  std::vector<double> out;
  for (int m = 1; m <= order; ++m) {
    double sum = -(2 * order + 1) * noise_variance;
    for (int n = -order; n <= order; ++n)
      sum += std::norm(axis == 0 ? print.coefficient(m, n) : print.coefficient(n, m));
    out.push_back(square_of(m) * std::max(0.0, sum));
  }
  return out;
}

// Envelope of the amplitudes m |c|, exp(level - fall f^2) at f cycles per pixel.
struct Envelope {
  double level = 0.0, fall = 0.0;
  // Fits a straight line to the logarithms. An order counts as the largest of three, because lines have no harmonic of
  // certain orders.
  Envelope(const std::vector<double>& powers, double pitch_px) {
    double n = 0.0, x = 0.0, y = 0.0, xx = 0.0, xy = 0.0;
    for (std::size_t k = 0; k < powers.size(); ++k) {
      const std::size_t first = k - std::min<std::size_t>(k, 1), last = std::min(k + 2, powers.size());
      const double most = *std::max_element(powers.begin() + static_cast<std::ptrdiff_t>(first),
                                            powers.begin() + static_cast<std::ptrdiff_t>(last));
      if (!(most > 0.0)) continue;
      const double f2 = square_of(static_cast<double>(k + 1) / pitch_px), height = 0.5 * std::log(most);
      n += 1.0, x += f2, y += height, xx += f2 * f2, xy += f2 * height;
    }
    if (n < 2.0) return;
    fall = std::max(0.0, -(xy - x * y / n) / (xx - x * x / n));
    level = (y + fall * x) / n;
  }
  [[nodiscard]] double at(double f) const { return std::exp(level - fall * f * f); }
};

double amplitude_along(const std::vector<double>& powers, double pitch_px) {
  double all = 0.0;
  for (const double power : powers) all += power;
  if (!(all > 0.0)) return 0.0;
  const Envelope envelope(powers, pitch_px);
  double folding = 0.0;
  for (int m = 1; 2 * m < pitch_px; ++m) {
    const double folded = pitch_px - m;  // order that folds onto m
    folding += envelope.at(m / pitch_px) * envelope.at(folded / pitch_px) / folded;
  }
  return kWorstLine * folding / all / kTwoPi;
}

// Returns the pitch along an axis in the image, px.
double pitch_px(const PatchFit& fit, int axis) {
  const std::size_t before = axis == 0 ? 3 : 1, after = axis == 0 ? 5 : 7;
  const double pitches =
      axis == 0 ? fit.print[after].x - fit.print[before].x : fit.print[after].y - fit.print[before].y;
  return length(fit.image[after] - fit.image[before]) / std::abs(pitches);
}

// Returns the mean of exp(2 pi i x) from x0 to x1.
std::complex<double> mean_phase(double x0, double x1) {
  const double half = 0.5 * kTwoPi * (x1 - x0);
  return std::polar(std::abs(half) > 1e-9 ? std::sin(half) / half : 1.0, 0.5 * kTwoPi * (x0 + x1));
}

}  // namespace

LockingAmplitude expected_locking(const PrintModel& model, const PatchFit& at_rest) {
  LockingAmplitude out{};
  const double gain = at_rest.gain[0];
  if (model.print.order() < kMinOrder || at_rest.pixels <= 0 || !(gain > 0.0)) return out;
  const double noise = at_rest.sigma * at_rest.sigma / (gain * gain * at_rest.pixels);
  for (const int axis : {0, 1}) {
    if (axis == 0 ? !model.options.along_x : !model.options.along_y) continue;
    const double pitch = pitch_px(at_rest, axis);
    const double amplitude = amplitude_along(slope_powers(model.print, axis, noise), pitch);
    const double covered = kCovered_px / pitch;
    out[static_cast<std::size_t>(axis)] = std::sqrt(std::max(0.0, amplitude * amplitude - covered * covered));
  }
  return out;
}

PixelPhase pixel_phase(const PatchFit& fit, const PatchWindow& window) {
  PixelPhase out{};
  const auto image_from_window = fit.window_from_image.inverse();
  const ImagePoint middle = image_from_window({0.0, 0.0});
  for (const int axis : {0, 1}) {
    const double centre = axis == 0 ? window.centre.x : window.centre.y,
                 half = axis == 0 ? window.half_x : window.half_y;
    const auto end = [&](double line, double side) {
      const double w = (line - centre) / half;
      return axis == 0 ? image_from_window({w, side}) : image_from_window({side, w});
    };
    const auto across = (axis == 0 ? image_from_window({1.0, 0.0}) : image_from_window({0.0, 1.0})) - middle;
    const bool is_along_x = std::abs(across.x) > std::abs(across.y);
    const auto coordinate = [&](ImagePoint p) { return is_along_x ? p.x : p.y; };
    std::complex<double> sum = 0.0;
    int lines = 0;
    for (double line = std::ceil(centre - half); line <= centre + half; line += 1.0, ++lines)
      sum += mean_phase(coordinate(end(line, -1.0)), coordinate(end(line, 1.0)));
    if (lines > 0) out[static_cast<std::size_t>(axis)] = sum / static_cast<double>(lines);
  }
  return out;
}

}  // namespace moiregauge::internal
