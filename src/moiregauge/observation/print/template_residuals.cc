// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/observation/print/template_residuals.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "moiregauge/units/units.h"

namespace moiregauge::internal {
namespace {

// Limits of covered blocks. Chosen.
constexpr double kThrice = 3.0;
constexpr double kBeyondNoise = 6.0;  // standard deviations of noise
constexpr double kMinFree = 0.4;      // relative to the window
// In a block. With fewer pixels its mean square is too uncertain.
constexpr int kMinPixels = 30;

// Returns the prediction of a fit: light, contrast and blur, but no width of lines.
PatchModel model_of(const PatchFit& fit, const PrintFromImage& map, const PatchWindow& window) {
  PatchModel model{map, window};
  model.light = fit.light, model.contrast = fit.gain;
  const auto blur = blur_of(fit);
  std::copy(blur.begin(), blur.end(), model.shape.begin());
  return model;
}

double median_of(const PrintMisses& m) {
  std::vector<double> all;
  for (std::size_t b = 0; b < kAllMissBlocks; ++b) {
    if (m.pixels[b] >= kMinPixels) all.push_back(m.mean_square[b]);
  }
  if (all.empty()) return 0.0;
  const auto middle = all.begin() + static_cast<std::ptrdiff_t>(all.size() / 2);
  std::nth_element(all.begin(), middle, all.end());
  return *middle;
}

// Rectangle of blocks: columns x0 to x1 and rows y0 to y1, ends excluded.
struct BlockRectangle {
  int x0 = 0, y0 = 0, x1 = 0, y1 = 0;
  [[nodiscard]] int area() const { return (x1 - x0) * (y1 - y0); }
  [[nodiscard]] bool is_free_of(const BlockSet& covered) const {
    for (int y = y0; y < y1; ++y) {
      for (int x = x0; x < x1; ++x) {
        if (covered[static_cast<std::size_t>(y * kMissBlocks + x)]) return false;
      }
    }
    return true;
  }
};

// Returns the larger of `best` and the largest free rectangle whose lowest block is (x0, y0).
BlockRectangle larger_free(const BlockSet& covered, int x0, int y0, BlockRectangle best) {
  for (int y1 = y0 + 1; y1 <= kMissBlocks; ++y1) {
    for (int x1 = x0 + 1; x1 <= kMissBlocks; ++x1) {
      const BlockRectangle here{x0, y0, x1, y1};
      if (here.area() > best.area() && here.is_free_of(covered)) best = here;
    }
  }
  return best;
}

}  // namespace

std::array<double, 2> blur_of(const PatchFit& fit) {
  std::array<double, 2> blur{};
  // By patch_fit.cc, fundamental = contrast - (2 pi)^2 blur.
  for (std::size_t a = 0; a < 2; ++a) blur[a] = (fit.gain[0] - fit.fundamental[a]) / (kTwoPi * kTwoPi);
  return blur;
}

PrintMisses template_residuals(const LumaView& luma, const PatchFit& fit, const PatchWindow& window,
                               const PrintTemplate& print, int row_step) {
  PrintMisses out;
  const PrintFromImage map = map_of(fit, window);
  PixelBox box = box_round(map.inverse(), window);
  box = {std::max(0, box.x0), std::max(0, box.y0), std::min(width_of(luma) - 1, box.x1),
         std::min(height_of(luma) - 1, box.y1)};
  const BlockSums sums = sum_blocks(luma, model_of(fit, map, window), print.nodes(), box, row_step);
  out.pixels = sums.pixels;
  for (std::size_t b = 0; b < kAllMissBlocks; ++b) {
    if (out.pixels[b] > 0) out.mean_square[b] = sums.squares[b] / out.pixels[b];
  }
  return out;
}

CoveredBlocks covered_blocks(const PrintMisses& then, const PrintMisses& now, double least) {
  CoveredBlocks out;
  const double usual_then = median_of(then), usual_now = median_of(now);
  if (!(usual_then > 0.0 && usual_now > 0.0)) return out;
  for (std::size_t b = 0; b < kAllMissBlocks; ++b) {
    if (then.pixels[b] < kMinPixels || now.pixels[b] < kMinPixels) continue;
    const double was = std::max(then.mean_square[b] / usual_then, 1.0);
    const double is = std::max(now.mean_square[b] / usual_now, 1.0);
    const double by_chance = std::exp(kBeyondNoise * std::sqrt(2.0 / then.pixels[b] + 2.0 / now.pixels[b]));
    const double limit = std::max(kThrice, by_chance);
    out.now[b] = is > limit * was && (is - was) * usual_now > least;
    out.then[b] = was > limit * is && (was - is) * usual_then > least;
    out.any_now |= out.now[b];
    out.any_then |= out.then[b];
  }
  return out;
}

std::optional<PatchWindow> free_window(const PatchWindow& window, const BlockSet& covered) {
  BlockRectangle best;
  for (int y0 = 0; y0 < kMissBlocks; ++y0) {
    for (int x0 = 0; x0 < kMissBlocks; ++x0) best = larger_free(covered, x0, y0, best);
  }
  if (best.area() < kMinFree * static_cast<double>(kAllMissBlocks)) return std::nullopt;
  const auto at = [](int block) { return 2.0 * block / kMissBlocks - 1.0; };
  return PatchWindow{{window.centre.x + 0.5 * (at(best.x0) + at(best.x1)) * window.half_x,
                      window.centre.y + 0.5 * (at(best.y0) + at(best.y1)) * window.half_y},
                     0.5 * (at(best.x1) - at(best.x0)) * window.half_x,
                     0.5 * (at(best.y1) - at(best.y0)) * window.half_y};
}

}  // namespace moiregauge::internal
