// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/observation/print/template_residuals.h"

#include <algorithm>
#include <cmath>
#include <variant>
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

// Predicted grey level of a pixel. It contains light, contrast and blur, but no width of lines.
class Expected {
 public:
  Expected(const PatchFit& fit, const PrintTemplate& print) : fit_(fit), print_(print) {
    // By patch_fit.cc, fundamental = contrast - (2 pi)^2 blur.
    for (std::size_t a = 0; a < 2; ++a) blur_[a] = (fit.gain[0] - fit.fundamental[a]) / (kTwoPi * kTwoPi);
  }
  [[nodiscard]] double operator()(ImagePoint at, PrintPoint p) const {
    const PrintLevel level = print_.at(p);
    return fit_.background(at) + fit_.contrast(at) * level.t + blur_[0] * level.dxx + blur_[1] * level.dyy;
  }

 private:
  const PatchFit& fit_;
  const PrintTemplate& print_;
  std::array<double, 2> blur_{};
};

int block_of(double uv) { return std::clamp(static_cast<int>(0.5 * (uv + 1.0) * kMissBlocks), 0, kMissBlocks - 1); }

template <typename Grey>
void gather_misses(const ImageView<Grey>& picture, const PatchFit& fit, const PrintFromImage& map, const PatchWindow& w,
                   const PrintTemplate& print, PrintMisses& out) {
  PixelBox box = box_round(map.inverse(), w);
  box = {std::max(0, box.x0), std::max(0, box.y0), std::min(picture.width - 1, box.x1),
         std::min(picture.height - 1, box.y1)};
  const Expected expected(fit, print);
  const auto to_window = window_from_print(w);
  for (int y = box.y0; y <= box.y1; ++y) {
    for (int x = box.x0; x <= box.x1; ++x) {
      const ImagePoint at{double(x), double(y)};
      const PrintPoint p = map(at);
      const auto uv = to_window(p);
      if (!(std::abs(uv.x) <= 1.0 && std::abs(uv.y) <= 1.0)) continue;
      const auto block = static_cast<std::size_t>(block_of(uv.y) * kMissBlocks + block_of(uv.x));
      const double off = static_cast<double>(picture.at(x, y)) - expected(at, p);
      out.mean_square[block] += off * off;
      ++out.pixels[block];
    }
  }
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

}  // namespace

PrintMisses template_residuals(const LumaView& luma, const PatchFit& fit, const PatchWindow& window,
                               const PrintTemplate& print) {
  PrintMisses out;
  const auto map = fit_homography<frame::Print, frame::Image>(std::span<const ImagePoint>(fit.image),
                                                              std::span<const PrintPoint>(fit.print));
  if (!map) return out;
  std::visit([&](const auto& picture) { gather_misses(picture, fit, *map, window, print, out); }, luma);
  for (std::size_t b = 0; b < kAllMissBlocks; ++b) {
    if (out.pixels[b] > 0) out.mean_square[b] /= out.pixels[b];
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
  int best = 0, best_x0 = 0, best_y0 = 0, best_x1 = 0, best_y1 = 0;
  const auto is_free = [&](int x0, int y0, int x1, int y1) {
    for (int y = y0; y < y1; ++y) {
      for (int x = x0; x < x1; ++x) {
        if (covered[static_cast<std::size_t>(y * kMissBlocks + x)]) return false;
      }
    }
    return true;
  };
  for (int y0 = 0; y0 < kMissBlocks; ++y0) {
    for (int x0 = 0; x0 < kMissBlocks; ++x0) {
      for (int y1 = y0 + 1; y1 <= kMissBlocks; ++y1) {
        for (int x1 = x0 + 1; x1 <= kMissBlocks; ++x1) {
          const int area = (x1 - x0) * (y1 - y0);
          if (area > best && is_free(x0, y0, x1, y1))
            best = area, best_x0 = x0, best_y0 = y0, best_x1 = x1, best_y1 = y1;
        }
      }
    }
  }
  if (best < kMinFree * static_cast<double>(kAllMissBlocks)) return std::nullopt;
  const auto at = [](int block) { return 2.0 * block / kMissBlocks - 1.0; };
  return PatchWindow{{window.centre.x + 0.5 * (at(best_x0) + at(best_x1)) * window.half_x,
                      window.centre.y + 0.5 * (at(best_y0) + at(best_y1)) * window.half_y},
                     0.5 * (at(best_x1) - at(best_x0)) * window.half_x,
                     0.5 * (at(best_y1) - at(best_y0)) * window.half_y};
}

}  // namespace moiregauge::internal
