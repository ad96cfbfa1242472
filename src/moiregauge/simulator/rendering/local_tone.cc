// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/simulator/rendering/local_tone.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

#include <tbb/parallel_for.h>

namespace moiregauge::internal::simulator {
namespace {

constexpr std::size_t kBins = 256;
using Curve = std::array<double, kBins + 1>;  // grey levels at the edges of the bins

// Rectangle of the image in px, right and bottom excluded.
struct Tile {
  int left, top, right, bottom;
};

Curve curve_of(const Image<double>& picture, const Tile& tile, double most_slope) {
  std::array<double, kBins> counts{};
  for (int y = tile.top; y < tile.bottom; ++y) {
    for (int x = tile.left; x < tile.right; ++x)
      counts[static_cast<std::size_t>(std::clamp(picture.at(x, y), 0.0, 255.0))] += 1.0;
  }
  const double all = static_cast<double>(tile.right - tile.left) * (tile.bottom - tile.top);
  const double most = most_slope * all / static_cast<double>(kBins);
  double beyond = 0.0;
  for (double& count : counts) {
    beyond += std::max(count - most, 0.0);
    count = std::min(count, most);
  }
  Curve curve{};
  for (std::size_t i = 0; i < kBins; ++i)
    curve[i + 1] = curve[i] + 255.0 / all * (counts[i] + beyond / static_cast<double>(kBins));
  return curve;
}

double value_of(const Curve& curve, double grey) {
  const double at = std::clamp(grey, 0.0, 255.0);
  const auto i = static_cast<std::size_t>(at);
  return curve[i] + (at - static_cast<double>(i)) * (curve[i + 1] - curve[i]);
}

// Two neighbouring tiles along one axis, and the position of a pixel between their middles (0 to 1).
struct Between {
  std::size_t low, high;
  double share;
};

class Tiles {
 public:
  Tiles(int size, int tile_px) : size_(size), count_(std::max(1, (size + tile_px / 2) / tile_px)) {}
  [[nodiscard]] int count() const { return count_; }
  [[nodiscard]] int edge(int i) const { return static_cast<int>(static_cast<long>(size_) * i / count_); }
  [[nodiscard]] Between at(int x) const {
    const double t = std::clamp((x + 0.5) * count_ / size_ - 0.5, 0.0, count_ - 1.0);
    const auto low = static_cast<std::size_t>(t);
    return {low, std::min(low + 1, static_cast<std::size_t>(count_ - 1)), t - static_cast<double>(low)};
  }

 private:
  int size_, count_;
};

}  // namespace

void map_local_tones(const LocalTone& how, Image<double>& picture) {
  const Tiles columns(picture.width(), how.tile_px), rows(picture.height(), how.tile_px);
  const auto across = static_cast<std::size_t>(columns.count());
  std::vector<Curve> curves(across * static_cast<std::size_t>(rows.count()));
  tbb::parallel_for(0, rows.count(), [&](int j) {
    for (int i = 0; i < columns.count(); ++i) {
      const Tile tile{columns.edge(i), rows.edge(j), columns.edge(i + 1), rows.edge(j + 1)};
      curves[static_cast<std::size_t>(j) * across + static_cast<std::size_t>(i)] =
          curve_of(picture, tile, how.most_slope);
    }
  });
  tbb::parallel_for(0, picture.height(), [&](int y) {
    const Between v = rows.at(y);
    for (int x = 0; x < picture.width(); ++x) {
      const Between u = columns.at(x);
      double& grey = picture.at(x, y);
      const auto mapped = [&](std::size_t row) {
        const double low = value_of(curves[row * across + u.low], grey);
        return low + u.share * (value_of(curves[row * across + u.high], grey) - low);
      };
      const double low = mapped(v.low), local = low + v.share * (mapped(v.high) - low);
      grey += how.strength * (local - grey);
    }
  });
}

}  // namespace moiregauge::internal::simulator
