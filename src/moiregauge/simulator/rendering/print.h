// SPDX-License-Identifier: Apache-2.0
// What is printed, seen through a Gaussian: closed forms, so that pictures are exact far below a thousandth of a pixel.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "moiregauge/simulator/scenario/scenario.h"

namespace moiregauge::internal::simulator {

// The Gaussian that blurs a board point, as covariance in mm^2.
struct Blur {
  Blur(double variance_x, double covariance, double variance_y)
      : xx(variance_x), xy(covariance), yy(variance_y), sigma_x(std::sqrt(xx)), sigma_y(std::sqrt(yy)) {}
  double xx, xy, yy;
  double sigma_x, sigma_y;  // mm
};

// A square pixel on the print: its centre, the sides of its cells, and how far the blur reaches.
struct Footprint {
  BoardPoint centre;
  double xu, xv, yu, yv;  // mm per pixel along u (right) and v (down)
  int cells;              // per side
  double reach_mm;        // beyond it nothing matters to any cell
};

// Shares of what a blurred eye sees: paper against background, and ink (black) against paper.
struct Seen {
  double paper = 0.0;
  double ink = 0.0;
};

// 0 and 1 alternating along one axis, symmetric about its zero.
class Stripes {
 public:
  Stripes() = default;
  // Every interval of half-width `half` about (n + offset) period, cut to [-reach, reach].
  Stripes(double period, double half, double offset, double reach);
  [[nodiscard]] static Stripes box(double reach);
  [[nodiscard]] double seen(double x, double sigma) const;
  // True when no edge is nearer than `distance`.
  [[nodiscard]] bool is_even(double x, double distance) const;

 private:
  // The first edge beyond x: a guess from the even spacing, put right by looking.
  [[nodiscard]] std::size_t first_edge_after(double x) const {
    const std::size_t count = edges_.size();
    if (count == 0) return 0;
    const double guess = std::clamp((x - edges_.front()) * edges_per_mm_, 0.0, static_cast<double>(count));
    auto i = static_cast<std::size_t>(guess);
    while (i > 0 && edges_[i - 1] > x) --i;
    while (i < count && edges_[i] <= x) ++i;
    return i;
  }
  void space() {
    const bool is_empty = edges_.empty();
    edges_per_mm_ = is_empty ? 0.0 : static_cast<double>(edges_.size() - 1) / (edges_.back() - edges_.front());
  }

  std::vector<double> edges_;  // rising; up, down, up, ...
  double edges_per_mm_ = 0.0;
};

// Share of a disc about the origin, seen from (x, y): a straight edge plus the first term of its curvature; chord by
// chord where the disc is so small that this would not do.
[[nodiscard]] double seen_disc(double x, double y, double radius, const Blur& blur);

// One grating in its own axes.
class PrintedGrating {
 public:
  PrintedGrating(const Grating& grating, bool inverted, const Ink& ink);
  [[nodiscard]] double ink(double x, double y, const Blur& blur) const;
  // True when all within `distance` has the same ink.
  [[nodiscard]] bool is_even(double x, double y, double distance) const;

 private:
  [[nodiscard]] double ink_uncorrelated(double x, double y, double sigma_x, double sigma_y) const;
  [[nodiscard]] bool is_even_x(double x, double distance) const;
  [[nodiscard]] bool is_even_y(double y, double distance) const;
  [[nodiscard]] double cosine_ink(double x, double y, const Blur& blur) const;
  [[nodiscard]] double offset_from_dot(double at, double size_mm) const;
  [[nodiscard]] double dots_ink(double x, double y, const Blur& blur) const;

  Grating grating_;
  bool inverted_;
  double dot_radius_;
  Stripes extent_x_, extent_y_, dark_x_, dark_y_, light_x_, light_y_;
};

// A marker's sheet: white paper, a grating, a disc.
class PrintedMarker {
 public:
  // `fold_mm`: by how much its part right of the centre has been pushed to the right; `seed`: of its ink.
  explicit PrintedMarker(const SceneMarker& marker, double fold_mm = 0.0, std::uint64_t seed = 0);
  // A bare sheet.
  PrintedMarker(BoardPoint low, BoardPoint high);
  // What a pixel sees of the sheet: the mean over its cells, each blurred.
  [[nodiscard]] Seen seen(const Footprint& pixel, const Blur& blur) const;
  // The sheet's corners: low, high.
  [[nodiscard]] BoardPoint low() const { return low_; }
  [[nodiscard]] BoardPoint high() const { return high_; }

 private:
  [[nodiscard]] double seen_paper(const Footprint& pixel, const Blur& blur) const;
  [[nodiscard]] double seen_circle(const Footprint& pixel, const Blur& blur) const;
  [[nodiscard]] double seen_grating(const Footprint& pixel, const Blur& blur) const;
  // Returns the ideal print's point for the ink that is really at a point of the grating's own axes.
  [[nodiscard]] BoardPoint smoothed(BoardPoint own) const;
  // Where on the flat sheet what is seen at x was printed.
  [[nodiscard]] double unfolded(double x) const { return x > crease_mm_ ? x - fold_mm_ : x; }

  double crease_mm_ = 0.0, fold_mm_ = 0.0;
  std::vector<PrintedGrating> grating_;  // none or one
  Grating where_;
  double cos_ = 1.0, sin_ = 0.0;
  Ink ink_;
  std::uint64_t ink_seed_ = 0;
  Circle circle_;  // diameter 0: none
  BoardPoint low_, high_;
  Stripes paper_x_, paper_y_;
};

}  // namespace moiregauge::internal::simulator
