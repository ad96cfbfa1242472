// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/detection/gratings/grating_seeds.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <span>

#include <Eigen/Core>
#include <opencv2/core.hpp>

#include "moiregauge/detection/gratings/grating_probe.h"
#include "moiregauge/units/units.h"

namespace moiregauge::internal {
namespace {

constexpr int kTile = 32;              // px at the scale of the level
constexpr double kLowestBin = 1.9;     // periods per tile; coarser lattices are left to the next level
constexpr double kHighestBin = 6.4;    // periods per tile; finer lattices are found at the previous level
constexpr double kFinestBin = 13.5;    // periods per tile at the first level: a pitch of 2.4 px
constexpr double kLobe = 1.7;          // bins, half width of the window's main lobe
constexpr double kPairShare = 0.25;    // smallest share of the spectrum's power in two fundamentals (chosen)
constexpr double kLinesShare = 0.5;    // smallest share in one fundamental (chosen)
constexpr double kMinExplained = 0.4;  // share of the variance; rejects most rough surfaces (grating_probe.h)
// Share of the variance. Thin lines spread their power over many harmonics, so the plain model may explain less.
constexpr double kMinPlainOfThin = 0.2;
constexpr double kMinThinExplained = 0.5;  // share of the variance (grating_probe.h)
constexpr double kSecondShare = 0.15;  // power of the second fundamental to the first: a weaker peak is none (chosen)

Image<float> halved(const Image<float>& from) {
  Image<float> out(from.width() / 2, from.height() / 2);
  for (int y = 0; y < out.height(); ++y) {
    for (int x = 0; x < out.width(); ++x)
      out.at(x, y) = 0.25F * (from.at(2 * x, 2 * y) + from.at(2 * x + 1, 2 * y) + from.at(2 * x, 2 * y + 1) +
                              from.at(2 * x + 1, 2 * y + 1));
  }
  return out;
}

using Line = Eigen::Array<double, kTile, 1>;

const Line& hann_window() {
  static const Line weights = 0.5 - 0.5 * (kTwoPi * (Line::LinSpaced(0, kTile - 1) + 0.5) / kTile).cos();
  return weights;
}

// Half of a tile's power spectrum: rows fy = -16..15, columns fx = 0..16.
class Spectrum {
 public:
  // Computes the spectrum of the tile at (x0, y0). Returns false if the tile is flat.
  bool of(const Image<float>& grey, int x0, int y0, double least_variance) {
    const Line& w = hann_window();
    const auto line = [&](int y) {
      return Eigen::Map<const Eigen::Array<float, kTile, 1>>(grey.row(y0 + y).data() + x0).cast<double>();
    };
    double sum = 0.0, squares = 0.0;
    for (int y = 0; y < kTile; ++y) {
      const Line greys = line(y), weighted = w * greys;
      sum += w(y) * weighted.sum();
      squares += w(y) * (weighted * greys).sum();
    }
    const double weight = w.sum() * w.sum(), mean = sum / weight;
    if (squares / weight - mean * mean < least_variance) return false;
    for (int y = 0; y < kTile; ++y)
      Eigen::Map<Eigen::Array<float, kTile, 1>>(tile_.ptr<float>(y)) = (w(y) * w * (line(y) - mean)).cast<float>();
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
  [[nodiscard]] double at(int fx, int fy) const {
    if (fx < 0) fx = -fx, fy = -fy;
    return std::abs(fy) >= kTile / 2 || fx > kTile / 2 ? 0.0 : power_[index(fx, fy)];
  }
  // Returns power and centroid (bins) of the 3 x 3 bins around a peak.
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
  // Returns the share of the total power in the 3 x 3 bins around the given places. Each bin counts once.
  [[nodiscard]] double share_about(std::span<const Eigen::Vector2d> places) const {
    std::vector<std::size_t> bins;
    for (const Eigen::Vector2d& f : places) {
      const int fx = static_cast<int>(std::lround(f.x())), fy = static_cast<int>(std::lround(f.y()));
      for (int i = 0; i < 9; ++i) {
        int x = fx + i % 3 - 1, y = fy + i / 3 - 1;
        if (x < 0) x = -x, y = -y;
        if (std::abs(y) >= kTile / 2 || x > kTile / 2) continue;
        bins.push_back(index(x, y));
        if (x == 0) bins.push_back(index(x, -y));
      }
    }
    std::sort(bins.begin(), bins.end());
    bins.erase(std::unique(bins.begin(), bins.end()), bins.end());
    double sum = 0.0;
    for (const std::size_t i : bins) sum += (is_single(i) ? 1.0 : 0.5) * power_[i];
    return sum / total_;
  }
  // Returns the strongest local maximum that passes. The flank of a stronger low frequency (an edge) is no maximum.
  template <typename Passes>
  [[nodiscard]] std::optional<Eigen::Vector2i> strongest(Passes passes) const {
    std::optional<Eigen::Vector2i> best;
    double most = 0.0;
    for (int fy = -kTile / 2 + 1; fy < kTile / 2; ++fy) {
      for (int fx = 0; fx < kTile / 2; ++fx) {
        const double p = at(fx, fy);
        if (p <= most || !passes(Eigen::Vector2d(fx, fy)) || !is_peak(fx, fy, p)) continue;
        best = Eigen::Vector2i(fx, fy);
        most = p;
      }
    }
    return best;
  }

 private:
  [[nodiscard]] bool is_peak(int fx, int fy, double p) const {
    for (int dy = -1; dy <= 1; ++dy) {
      for (int dx = -1; dx <= 1; ++dx) {
        if (at(fx + dx, fy + dy) > p) return false;
      }
    }
    return true;
  }
  // Returns true for a bin without its mirror image in the array. The first and the last column contain both.
  static bool is_single(std::size_t i) { return i % (kTile / 2 + 1) != 0 && i % (kTile / 2 + 1) != kTile / 2; }
  static std::size_t index(int fx, int fy) { return static_cast<std::size_t>((fy + kTile / 2) * (kTile / 2 + 1) + fx); }
  cv::Mat tile_ = cv::Mat(kTile, kTile, CV_32F);
  cv::Mat complex_;
  std::array<double, kTile*(kTile / 2 + 1)> power_{};
  double total_ = 0.0;
};

std::optional<LatticeSeed> seed_of(const Spectrum& spectrum, double highest_bin) {
  const auto first = spectrum.strongest([](const Eigen::Vector2d& f) { return f.squaredNorm() > kLobe * kLobe; });
  if (!first) return std::nullopt;
  const auto [power1, k1] = spectrum.lobe(*first);
  if (k1.norm() < kLowestBin || k1.norm() > highest_bin) return std::nullopt;
  // A perspective or oblique view changes angle and ratio of the fundamentals, but not beyond these limits (chosen).
  const auto second = spectrum.strongest([&k = k1](const Eigen::Vector2d& f) {
    const double ratio = f.norm() / k.norm();
    return ratio > 0.6 && ratio < 1.6 && std::abs(f.dot(k)) < 0.5 * f.norm() * k.norm() && f.norm() > kLobe;
  });
  LatticeSeed seed;
  seed.k1 = k1 / kTile;
  std::vector<Eigen::Vector2d> places{k1};
  if (second) {
    const auto [power2, k2] = spectrum.lobe(*second);
    if (power2 > kSecondShare * power1) {
      seed.k2 = k2 / kTile;
      places.insert(places.end(), {k2, k1 + k2, k1 - k2});
    }
  }
  seed.score = spectrum.share_about(places);
  if (seed.score < (seed.k2.isZero() ? kLinesShare : kPairShare)) return std::nullopt;
  return seed;
}

// Adds the seeds of one level that have the highest score among their neighbouring tiles.
void add_level(const Image<float>& grey, int scale, double min_modulation, std::vector<LatticeSeed>& out) {
  const int hop = scale == 1 ? 8 : 6;
  const int across = (grey.width() - kTile) / hop + 1, down = (grey.height() - kTile) / hop + 1;
  std::vector<std::optional<LatticeSeed>> seeds(static_cast<std::size_t>(across) * static_cast<std::size_t>(down));
  const auto place = [&](int i, int j) {
    return static_cast<std::size_t>(j) * static_cast<std::size_t>(across) + static_cast<std::size_t>(i);
  };
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

LatticeSeeds find_lattice_seeds(const Image<float>& grey, double min_modulation) {
  LatticeSeeds found;
  std::vector<LatticeSeed>& seeds = found.plain;
  Image<float> level = grey;
  for (int scale = 1; level.width() >= kTile && level.height() >= kTile; scale *= 2) {
    add_level(level, scale, min_modulation, seeds);
    level = halved(level);
  }
  for (LatticeSeed& seed : seeds) {
    seed.score = explained_by(seed, grey);
    if (seed.score < kMinPlainOfThin || seed.k2.isZero()) continue;
    LatticeSeed thin = seed;
    thin.score = explained_by_thin_lines(seed, grey);
    if (thin.score > kMinThinExplained) found.thin_lines.push_back(thin);
  }
  std::erase_if(seeds, [](const LatticeSeed& seed) { return seed.score < kMinExplained; });
  for (auto* list : {&found.plain, &found.thin_lines}) {
    std::stable_sort(list->begin(), list->end(),
                     [](const LatticeSeed& a, const LatticeSeed& b) { return a.score > b.score; });
  }
  return found;
}

}  // namespace moiregauge::internal
