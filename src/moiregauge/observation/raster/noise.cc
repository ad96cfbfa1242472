// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/observation/raster/noise.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <vector>

#include "moiregauge/observation/raster/pixel_sums.h"

namespace moiregauge::internal {
namespace {

// Noise of the rounding to whole grey levels, 1 / sqrt(12). No estimate may be lower.
constexpr double kRounding = 0.28867513459481287;

// Numbers of responses by magnitude. Larger ones are counted together.
constexpr std::size_t kMagnitudes = 4096;

// Responses of the mask in half of the pixels, like the black squares of a chessboard.
template <typename Grey>
std::vector<int> responses_in(const ImageView<Grey>& p) {
  std::vector<int> out(static_cast<std::size_t>(p.height - 2) * static_cast<std::size_t>((p.width - 1) / 2));
  std::size_t n = 0;
  for (int y = 1; y + 1 < p.height; ++y) {
    const Grey* a = p.data + (y - 1) * p.stride;
    const Grey* b = p.data + y * p.stride;
    const Grey* c = p.data + (y + 1) * p.stride;
    for (int x = 1 + (y + 1) % 2; x + 1 < p.width; x += 2) {
      out[n++] = std::abs(a[x - 1] - 2 * a[x] + a[x + 1] - 2 * b[x - 1] + 4 * b[x] - 2 * b[x + 1] + c[x - 1] -
                          2 * c[x] + c[x + 1]);
    }
  }
  out.resize(n);
  return out;
}

// Median of integers, interpolated within its step, or small noise would change in jumps.
double median_of(std::vector<int>& responses) {
  std::array<std::int32_t, kMagnitudes> counts{};
  for (const int r : responses) ++counts[std::min(static_cast<std::size_t>(r), kMagnitudes - 1)];
  const auto half = static_cast<std::ptrdiff_t>(responses.size() / 2);
  std::ptrdiff_t below = 0;
  std::size_t m = 0;
  while (below + counts[m] <= half) below += counts[m++];
  std::ptrdiff_t equal = counts[m];
  auto median = static_cast<int>(m);
  if (m + 1 == kMagnitudes) {
    std::nth_element(responses.begin(), responses.begin() + half, responses.end());
    median = responses[static_cast<std::size_t>(half)];
    below = std::count_if(responses.begin(), responses.end(), [median](int r) { return r < median; });
    equal = std::count(responses.begin(), responses.end(), median);
  }
  const double within = (0.5 * double(responses.size()) - double(below)) / double(equal);
  return median == 0 ? 0.5 * within : median - 0.5 + within;
}

template <typename Grey>
PixelNoise noise_in(const ImageView<Grey>& p, int bits) {
  std::vector<int> responses = responses_in(p);
  if (responses.empty()) return {kRounding, 0.0};
  const long clipped = count_clipped(p.part(1, 1, p.width - 2, p.height - 2), (1 << bits) - 1);
  return {std::max(kRounding, 1.4826 * median_of(responses) / 6.0),
          double(clipped) / (double(p.width - 2) * double(p.height - 2))};
}

}  // namespace

PixelNoise pixel_noise(const LumaView& part, int bits) {
  return std::visit(
      [&](const auto& pixels) {
        return pixels.width < 3 || pixels.height < 3 ? PixelNoise{kRounding, 0.0} : noise_in(pixels, bits);
      },
      part);
}

double clipped_share(const LumaView& part, int bits) {
  return std::visit(
      [&](const auto& pixels) {
        if (pixels.width == 0 || pixels.height == 0) return 0.0;
        const long clipped = count_clipped(pixels, (1 << bits) - 1);
        return static_cast<double>(clipped) / (static_cast<double>(pixels.width) * pixels.height);
      },
      part);
}

}  // namespace moiregauge::internal
