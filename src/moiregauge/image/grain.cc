// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/image/grain.h"

#include <algorithm>
#include <span>

#include <Eigen/Cholesky>

namespace moiregauge::internal {
namespace {

constexpr int kTilePixels = kGrainTile * kGrainTile;
constexpr int kInner = kGrainTile - 2;  // pixels with neighbours for a gradient
constexpr int kInnerPixels = kInner * kInner;
constexpr int kParameters = 4;  // offset, contrast, movement along x and y
// Ridge for flat tiles, which have no gradients to fit. Relative to the squared length of the constant column. Chosen.
constexpr double kRidge = 1e-9;

using TilePixels = std::span<const std::uint16_t>;
using Columns = Eigen::Matrix<double, kInnerPixels, kParameters>;
using Values = Eigen::Matrix<double, kInnerPixels, 1>;

// Calls visit(k, i) for the k-th inner pixel, which is the tile's i-th.
template <typename Visit>
void for_inner_pixels(Visit visit) {
  int k = 0;
  for (int y = 1; y <= kInner; ++y) {
    for (int x = 1; x <= kInner; ++x) visit(k++, y * kGrainTile + x);
  }
}

// Removes offset, contrast and movement, with the mean of the three frames as their shape.
class Detrending {
 public:
  explicit Detrending(const std::array<TilePixels, 3>& frames) {
    std::array<double, kTilePixels> mean{};
    for (int i = 0; i < kTilePixels; ++i) {
      const auto at = static_cast<std::size_t>(i);
      mean[at] = (frames[0][at] + frames[1][at] + frames[2][at]) / 3.0;
    }
    for_inner_pixels([&](int k, int i) {
      const auto at = static_cast<std::size_t>(i);
      columns_(k, 0) = 1.0;
      columns_(k, 1) = mean[at];
      columns_(k, 2) = 0.5 * (mean[at + 1] - mean[at - 1]);
      columns_(k, 3) = 0.5 * (mean[at + kGrainTile] - mean[at - kGrainTile]);
    });
    columns_.col(1).array() -= columns_.col(1).mean();
    normal_ = columns_.transpose() * columns_;
    normal_.diagonal().array() += kRidge * kInnerPixels;
    solver_.compute(normal_);
  }
  // Returns the squared residual of the difference of two frames.
  [[nodiscard]] double rest(TilePixels a, TilePixels b) const {
    Values difference;
    for_inner_pixels([&](int k, int i) {
      const auto at = static_cast<std::size_t>(i);
      difference(k) = static_cast<double>(a[at]) - static_cast<double>(b[at]);
    });
    const Eigen::Matrix<double, kParameters, 1> fitted = solver_.solve(columns_.transpose() * difference);
    return (difference - columns_ * fitted).squaredNorm();
  }

 private:
  Columns columns_;
  Eigen::Matrix<double, kParameters, kParameters> normal_;
  Eigen::LDLT<Eigen::Matrix<double, kParameters, kParameters>> solver_;
};

// Returns the sum of squares of the Laplacian of the difference of two frames, scaled to the variance of grain. It
// leaves a fifth of the variance of texture that a point spread of 0.7 px has blurred.
double rest_of_laplacian(TilePixels a, TilePixels b) {
  constexpr double kGain = 20.0;  // gain for white noise: 4^2 + 4
  const auto difference = [&](int i) {
    const auto at = static_cast<std::size_t>(i);
    return static_cast<double>(a[at]) - static_cast<double>(b[at]);
  };
  double sum = 0.0;
  for_inner_pixels([&](int, int i) {
    const double rest = 4.0 * difference(i) - difference(i - 1) - difference(i + 1) - difference(i - kGrainTile) -
                        difference(i + kGrainTile);
    sum += rest * rest;
  });
  return sum / kGain;
}
// Share of independent values of the Laplacian. Their correlation is -0.4 with four neighbours, and 0.1 and 0.05 with
// four more each.
constexpr double kIndependentOfLaplacian = 1.0 / (1.0 + 4.0 * 0.4 * 0.4 + 4.0 * 0.1 * 0.1 + 4.0 * 0.05 * 0.05);

// Returns the variance of a tile about a plane, because blur and shading leave planes.
double roughness(TilePixels tile) {
  double sum = 0.0, sum2 = 0.0, along_x = 0.0, along_y = 0.0, lever = 0.0;
  constexpr double kMiddle = 0.5 * (kGrainTile - 1);
  for (int i = 0; i < kTilePixels; ++i) {
    const int column = i % kGrainTile, row = i / kGrainTile;
    const double grey = tile[static_cast<std::size_t>(i)], x = column - kMiddle, y = row - kMiddle;
    sum += grey, sum2 += grey * grey;
    along_x += x * grey, along_y += y * grey, lever += x * x;
  }
  return (sum2 - sum * sum / kTilePixels - (along_x * along_x + along_y * along_y) / lever) / (kTilePixels - 3);
}

bool is_clipped(TilePixels tile, int white) {
  return std::any_of(tile.begin(), tile.end(), [white](std::uint16_t grey) { return grey == 0 || grey >= white; });
}

// Keeps the tiles whose roughness in all frames is noise. It is at most twice that of the smoothest tenth (chosen).
void keep_flat(std::vector<std::array<TilePixels, 3>>& tiles) {
  std::vector<double> rough;
  rough.reserve(tiles.size());
  for (const auto& tile : tiles)
    rough.push_back(std::max({roughness(tile[0]), roughness(tile[1]), roughness(tile[2])}));
  if (rough.empty()) return;
  std::vector<double> sorted = rough;
  const auto tenth = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 10);
  std::nth_element(sorted.begin(), tenth, sorted.end());
  std::size_t kept = 0;
  for (std::size_t t = 0; t < tiles.size(); ++t) {
    if (rough[t] <= 2.0 * *tenth) tiles[kept++] = tiles[t];
  }
  tiles.resize(kept);
}

// Squared residuals of a tile's three pairs of frames.
struct PairResiduals {
  double newer = 0.0, older = 0.0;  // frames one apart
  double two_apart = 0.0;
  [[nodiscard]] double largest() const { return std::max({newer, older, two_apart}); }
  [[nodiscard]] double smallest() const { return std::min({newer, older, two_apart}); }
};

// Removes tiles that something covered or uncovered within the three frames. Such a step counts half in the frames one
// apart, and an average over time looks the same. Behind a codec, residuals of independent frames differ as much,
// because it keeps or changes whole coefficients.
void remove_changed(std::vector<PairResiduals>& tiles) {
  // An average over time doubles residuals at most, and those of a tile scatter by a quarter. Tiles of usual residuals
  // stay in any case.
  constexpr double kChange = 3.0;
  if (tiles.empty()) return;
  std::vector<double> largest;
  largest.reserve(tiles.size());
  for (const PairResiduals& tile : tiles) largest.push_back(tile.largest());
  const auto middle = largest.begin() + static_cast<std::ptrdiff_t>(largest.size() / 2);
  std::nth_element(largest.begin(), middle, largest.end());
  const double usual = *middle;
  std::erase_if(tiles, [usual](const PairResiduals& tile) {
    return tile.largest() > std::max(kChange * tile.smallest(), usual);
  });
}

}  // namespace

void GrainSampler::place(std::vector<PixelPosition> tiles) {
  tiles_ = std::move(tiles);
  interrupt();
}

void GrainSampler::add(const LumaView& luma, int white, const GrainConditions& conditions) {
  const bool is_still = conditions.is_still;
  std::rotate(is_uniform_.begin(), is_uniform_.begin() + 2, is_uniform_.end());
  is_uniform_[0] = conditions.is_uniform;
  std::rotate(frames_.begin(), frames_.begin() + 2, frames_.end());
  auto& newest = frames_[0];
  newest.clear();
  std::visit(
      [&](const auto& picture) {
        for (const PixelPosition& tile : tiles_) {
          for (int y = 0; y < kGrainTile; ++y) {
            const auto row = picture.row(tile.y + y).subspan(static_cast<std::size_t>(tile.x), kGrainTile);
            newest.insert(newest.end(), row.begin(), row.end());
          }
        }
      },
      luma);
  filled_ = std::min(filled_ + 1, 3);
  if (filled_ < 3) return;
  std::vector<std::array<TilePixels, 3>> whole;
  const auto has_edges = [](const std::vector<bool>& uniform, std::size_t t) {
    return !uniform.empty() && !uniform[t];
  };
  for (std::size_t t = 0; t < tiles_.size(); ++t) {
    if (!is_still && std::ranges::any_of(is_uniform_, [&](const auto& uniform) { return has_edges(uniform, t); }))
      continue;
    std::array<TilePixels, 3> tile;
    for (std::size_t n = 0; n < tile.size(); ++n)
      tile[n] = TilePixels(frames_[n]).subspan(t * kTilePixels, kTilePixels);
    if (std::none_of(tile.begin(), tile.end(), [white](TilePixels one) { return is_clipped(one, white); }))
      whole.push_back(tile);
  }
  if (!is_still) keep_flat(whole);
  std::vector<PairResiduals> tiles;
  for (const auto& tile : whole) {
    if (is_still) {
      const Detrending detrended(tile);
      tiles.push_back(
          {detrended.rest(tile[0], tile[1]), detrended.rest(tile[1], tile[2]), detrended.rest(tile[0], tile[2])});
    } else {
      tiles.push_back({rest_of_laplacian(tile[0], tile[1]), rest_of_laplacian(tile[1], tile[2]),
                       rest_of_laplacian(tile[0], tile[2])});
    }
  }
  if (conditions.is_lossless) remove_changed(tiles);
  GrainSums& sums = is_still ? still_ : moving_;
  const double weight = is_still ? 1.0 : kIndependentOfLaplacian;
  for (const PairResiduals& tile : tiles) {
    const double a = 0.5 * weight * (tile.newer + tile.older), b = weight * tile.two_apart;
    sums.one_apart += a, sums.two_apart += b;
    sums.products[0] += a * a, sums.products[1] += a * b, sums.products[2] += b * b;
    sums.values += is_still ? kInnerPixels - kParameters : kIndependentOfLaplacian * kInnerPixels;
  }
}

}  // namespace moiregauge::internal
