// SPDX-License-Identifier: Apache-2.0
// Printed patterns convolved with a Gaussian, in closed form: positions are exact far below 0.001 px.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "moiregauge/simulator/scenario/scenario.h"

namespace moiregauge::internal::simulator {

// Gaussian blur on the sheet.
struct Blur {
  Blur(double variance_x, double covariance, double variance_y)
      : xx(variance_x), xy(covariance), yy(variance_y), sigma_x(std::sqrt(xx)), sigma_y(std::sqrt(yy)) {}
  double xx, xy, yy;        // mm^2, covariance
  double sigma_x, sigma_y;  // mm
};

// Projection of a square pixel onto the sheet.
struct Footprint {
  BoardPoint centre;      // mm
  double xu, xv, yu, yv;  // mm per px along u (right) and v (down)
  int cells;              // per side
  double reach_mm;        // mm from the centre; points farther away do not affect any cell
};

// Blurred shares of a pixel: paper against background, and ink (black) against paper.
struct Seen {
  double paper = 0.0;
  double ink = 0.0;
};

// Function of one axis that alternates between 0 and 1, symmetric about 0.
class Stripes {
 public:
  Stripes() = default;
  // Intervals of half width `half` around (n + offset) * period, cut to [-reach, reach]. All in mm.
  Stripes(double period, double half, double offset, double reach);
  // Returns one interval, [-reach, reach].
  [[nodiscard]] static Stripes box(double reach);
  // Returns the value at x, blurred by a Gaussian.
  [[nodiscard]] double seen(double x, double sigma) const;
  // Returns true if no edge is within `distance` of x.
  [[nodiscard]] bool is_even(double x, double distance) const;

 private:
  // Returns the index of the first edge beyond x, starting from a guess by the mean spacing.
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

  std::vector<double> edges_;  // mm, ascending; the value goes up at even indices, down at odd ones
  double edges_per_mm_ = 0.0;
};

// Returns the blurred value at (x, y) of a disc around the origin. Uses a straight edge plus the first term of its
// curvature, or chords if the radius is below six sigma.
[[nodiscard]] double seen_disc(double x, double y, double radius, const Blur& blur);

// Grating in its own axes, mm from its symmetry point.
class PrintedGrating {
 public:
  PrintedGrating(const Grating& grating, bool inverted, const Ink& ink);
  // Returns the blurred share of ink at a point.
  [[nodiscard]] double ink(double x, double y, const Blur& blur) const;
  // Returns true if the ink is uniform within `distance` of a point.
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

// Sheet of a marker: white paper, a grating, a disc.
class PrintedMarker {
 public:
  // `fold_mm` is the shift to the right of the part right of the centre. `seed` determines the roughness of the ink.
  explicit PrintedMarker(const SceneMarker& marker, double fold_mm = 0.0, std::uint64_t seed = 0);
  // Blank sheet.
  PrintedMarker(BoardPoint low, BoardPoint high);
  // Returns the shares of paper and ink in a pixel: the mean over its cells, each blurred.
  [[nodiscard]] Seen seen(const Footprint& pixel, const Blur& blur) const;
  // Corners of the sheet, mm.
  [[nodiscard]] BoardPoint low() const { return low_; }
  [[nodiscard]] BoardPoint high() const { return high_; }

 private:
  [[nodiscard]] double seen_paper(const Footprint& pixel, const Blur& blur) const;
  [[nodiscard]] double seen_circle(const Footprint& pixel, const Blur& blur) const;
  [[nodiscard]] double seen_grating(const Footprint& pixel, const Blur& blur) const;
  // Returns the point of the ideal grating whose ink is at a point of the rough one.
  [[nodiscard]] BoardPoint smoothed(BoardPoint own) const;
  // Returns the position on the flat sheet of a point at x on the folded one.
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
