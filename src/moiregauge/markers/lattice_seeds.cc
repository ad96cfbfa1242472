// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/markers/lattice_seeds.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include <opencv2/core.hpp>

#include "moiregauge/units/units.h"

namespace moiregauge {
namespace {

constexpr int kTile = 32;             // pixels of the level
constexpr double kLowestBin = 2.5;    // fewer periods in a tile are not a lattice yet; the next level sees them
constexpr double kHighestBin = 6.4;   // finer ones belong to the level before
constexpr double kFinestBin = 13.5;   // but for the first level: 2.4 px
constexpr double kLobe = 1.7;         // bins, the main lobe of the window
constexpr double kPairShare = 0.25;   // of the spectrum, that two fundamentals must hold
constexpr double kLinesShare = 0.5;   // and one

Image<float> halved(const Image<float>& from) {
  Image<float> out(from.width() / 2, from.height() / 2);
  for (int y = 0; y < out.height(); ++y) {
    for (int x = 0; x < out.width(); ++x)
      out.at(x, y) = 0.25F * (from.at(2 * x, 2 * y) + from.at(2 * x + 1, 2 * y) + from.at(2 * x, 2 * y + 1) +
                              from.at(2 * x + 1, 2 * y + 1));
  }
  return out;
}

const std::array<float, kTile>& hann() {
  static const std::array<float, kTile> weights = [] {
    std::array<float, kTile> w{};
    for (int i = 0; i < kTile; ++i)
      w[static_cast<std::size_t>(i)] = static_cast<float>(0.5 - 0.5 * std::cos(kTurn * (i + 0.5) / kTile));
    return w;
  }();
  return weights;
}

// Half of the power spectrum: fy = -16..15 by row, fx = 0..16 by column.
class Spectrum {
 public:
  // False when the tile is flat.
  bool of(const Image<float>& grey, int x0, int y0, double least_variance) {
    const auto& w = hann();
    double sum = 0.0, squares = 0.0, weight = 0.0;
    for (int y = 0; y < kTile; ++y) {
      const auto row = grey.row(y0 + y).subspan(static_cast<std::size_t>(x0), kTile);
      for (std::size_t x = 0; x < kTile; ++x) {
        const double ww = w[static_cast<std::size_t>(y)] * w[x], g = row[x];
        sum += ww * g;
        squares += ww * g * g;
        weight += ww;
      }
    }
    const double mean = sum / weight;
    variance_ = squares / weight - mean * mean;
    if (variance_ < least_variance) return false;
    for (int y = 0; y < kTile; ++y) {
      const auto row = grey.row(y0 + y).subspan(static_cast<std::size_t>(x0), kTile);
      auto* out = tile_.ptr<float>(y);
      for (std::size_t x = 0; x < kTile; ++x)
        out[x] = (row[x] - static_cast<float>(mean)) * w[static_cast<std::size_t>(y)] * w[x];
    }
    cv::dft(tile_, complex_, cv::DFT_COMPLEX_OUTPUT);
    total_ = 0.0;
    for (int fy = -kTile / 2; fy < kTile / 2; ++fy) {
      for (int fx = 0; fx <= kTile / 2; ++fx) {
        const auto v = complex_.at<cv::Vec2f>((fy + kTile) % kTile, fx);
        const double re = double{v[0]}, im = double{v[1]}, p = re * re + im * im;
        power_[index(fx, fy)] = p;
        total_ += fx == 0 || fx == kTile / 2 ? 0.5 * p : p;
      }
    }
    return true;
  }
  [[nodiscard]] double variance() const { return variance_; }
  [[nodiscard]] double total() const { return total_; }
  [[nodiscard]] double at(int fx, int fy) const {
    if (fx < 0) fx = -fx, fy = -fy;
    return std::abs(fy) >= kTile / 2 || fx > kTile / 2 ? 0.0 : power_[index(fx, fy)];
  }
  // Power and centroid of the lobe about a peak.
  [[nodiscard]] std::pair<double, Eigen::Vector2d> lobe(Eigen::Vector2i peak) const {
    double sum = 0.0;
    Eigen::Vector2d centroid(0, 0);
    for (int dy = -1; dy <= 1; ++dy) {
      for (int dx = -1; dx <= 1; ++dx) {
        const double p = at(peak.x() + dx, peak.y() + dy);
        sum += p;
        centroid += p * Eigen::Vector2d(peak.x() + dx, peak.y() + dy);
      }
    }
    return {sum, centroid / sum};
  }
  // The strongest bin that passes.
  template <typename Passes>
  [[nodiscard]] std::optional<Eigen::Vector2i> strongest(Passes passes) const {
    std::optional<Eigen::Vector2i> best;
    for (int fy = -kTile / 2 + 1; fy < kTile / 2; ++fy) {
      for (int fx = 0; fx < kTile / 2; ++fx) {
        if (passes(Eigen::Vector2d(fx, fy)) && (!best || at(fx, fy) > at(best->x(), best->y())))
          best = Eigen::Vector2i(fx, fy);
      }
    }
    return best;
  }

 private:
  static std::size_t index(int fx, int fy) { return static_cast<std::size_t>((fy + kTile / 2) * (kTile / 2 + 1) + fx); }
  cv::Mat tile_ = cv::Mat(kTile, kTile, CV_32F);
  cv::Mat complex_;
  std::array<double, kTile*(kTile / 2 + 1)> power_{};
  double total_ = 0.0;
  double variance_ = 0.0;
};

std::optional<LatticeSeed> seed_of(const Spectrum& spectrum, double highest_bin) {
  const auto first = spectrum.strongest([](const Eigen::Vector2d&) { return true; });
  if (!first || first->cast<double>().norm() < kLowestBin - 0.6) return std::nullopt;
  const auto [power1, k1] = spectrum.lobe(*first);
  if (k1.norm() < kLowestBin || k1.norm() > highest_bin) return std::nullopt;
  // Perspective and oblique views bring the second one off square, never near the first.
  const auto second = spectrum.strongest([&k = k1](const Eigen::Vector2d& f) {
    const double ratio = f.norm() / k.norm();
    return ratio > 0.6 && ratio < 1.6 && std::abs(f.dot(k)) < 0.5 * f.norm() * k.norm() && f.norm() > kLobe;
  });
  LatticeSeed seed;
  seed.k1 = k1 / kTile;
  double held = power1;
  if (second) {
    const auto [power2, k2] = spectrum.lobe(*second);
    if (power2 > 0.15 * power1) {
      seed.k2 = k2 / kTile;
      held += power2;
    }
  }
  const double share = held / spectrum.total();
  if (share < (seed.k2.isZero() ? kLinesShare : kPairShare)) return std::nullopt;
  seed.score = share * spectrum.variance();
  return seed;
}

// Seeds of one level that no neighbouring tile beats.
void add_level(const Image<float>& grey, int scale, double min_modulation, std::vector<LatticeSeed>& out) {
  const int hop = scale == 1 ? 8 : 4;
  const int across = (grey.width() - kTile) / hop + 1, down = (grey.height() - kTile) / hop + 1;
  std::vector<std::optional<LatticeSeed>> seeds(static_cast<std::size_t>(across) * static_cast<std::size_t>(down));
  const auto place = [&](int i, int j) { return static_cast<std::size_t>(j) * static_cast<std::size_t>(across) + static_cast<std::size_t>(i); };
  Spectrum spectrum;
  for (int j = 0; j < down; ++j) {
    for (int i = 0; i < across; ++i) {
      if (spectrum.of(grey, i * hop, j * hop, 0.25 * min_modulation * min_modulation))
        seeds[place(i, j)] = seed_of(spectrum, scale == 1 ? kFinestBin : kHighestBin);
    }
  }
  for (int j = 0; j < down; ++j) {
    for (int i = 0; i < across; ++i) {
      if (!seeds[place(i, j)]) continue;
      LatticeSeed seed = *seeds[place(i, j)];
      bool beaten = false;
      for (int b = std::max(0, j - 1); b <= std::min(down - 1, j + 1); ++b) {
        for (int a = std::max(0, i - 1); a <= std::min(across - 1, i + 1); ++a)
          beaten |= seeds[place(a, b)] && seeds[place(a, b)]->score > seed.score;
      }
      if (beaten) continue;
      const double middle = 0.5 * (kTile - 1), shift = 0.5 * (scale - 1);
      seed.centre = {scale * (i * hop + middle) + shift, scale * (j * hop + middle) + shift};
      seed.k1 /= scale;
      seed.k2 /= scale;
      out.push_back(seed);
    }
  }
}

}  // namespace

std::vector<LatticeSeed> find_lattice_seeds(const Image<float>& grey, double min_modulation) {
  std::vector<LatticeSeed> seeds;
  Image<float> level = grey;
  for (int scale = 1; level.width() >= kTile && level.height() >= kTile; scale *= 2) {
    add_level(level, scale, min_modulation, seeds);
    level = halved(level);
  }
  std::stable_sort(seeds.begin(), seeds.end(), [](const LatticeSeed& a, const LatticeSeed& b) { return a.score > b.score; });
  return seeds;
}

}  // namespace moiregauge
