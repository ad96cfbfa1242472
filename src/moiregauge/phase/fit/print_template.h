// SPDX-License-Identifier: Apache-2.0
// Template: grey levels of one period of a grating, as a Fourier series over the pitch in both directions. It contains
// all harmonics and cross terms of a binary grating, rounded by lens and pixel.
#pragma once

#include <array>
#include <complex>
#include <cstdint>
#include <span>
#include <vector>

#include <tl/expected.hpp>

#include "moiregauge/units/point.h"

namespace moiregauge::internal {

namespace frame {
// Grating coordinates: pitches along the grating's two axes, 0 at its symmetry point. On an upright grating x is right
// and y is up.
struct Print;
}  // namespace frame
using PrintPoint = Point<frame::Print>;

// Grey level and its derivatives per pitch.
struct PrintLevel {
  double t = 0.0;
  double dx = 0.0;
  double dy = 0.0;
  double dxx = 0.0;
  double dyy = 0.0;
};

// Table of the period on a grid of nodes, each with a Taylor series of second order. The nearest node gives t and its
// slopes without a look at its neighbours. Steps between nodes are as small as the error of the series. A node has six
// coefficients of 16 bits, two per word, in the order of kNodePowers. Coefficient k is its 16 bits times scale[k], in
// units of the node distance.
struct PrintNodes {
  static constexpr int kWords = 3;
  // Words from node to node. A node is loaded as one vector of 16 bytes.
  static constexpr int kStride = 4;
  int side = 0;  // nodes per pitch; the table has one more on every side
  std::vector<std::int32_t> words;
  std::array<float, 2 * kWords> scale{};
  [[nodiscard]] int wide() const { return side + 2; }
};

struct NodePower {
  int x, y;
};
inline constexpr std::array kNodePowers{NodePower{0, 0}, NodePower{1, 0}, NodePower{0, 1},
                                        NodePower{2, 0}, NodePower{1, 1}, NodePower{0, 2}};
static_assert(kNodePowers.size() == 2 * PrintNodes::kWords);

// Series t(X, Y) = sum over |m|, |n| <= order of c(m, n) exp(2 pi i (m X + n Y)), real, without its mean (c(0, 0) = 0).
class PrintSeries {
 public:
  // Takes (2 order + 1)^2 coefficients, n slowest, both from -order. Symmetry makes the series real.
  PrintSeries(int order, std::span<const std::complex<double>> series);

  [[nodiscard]] int order() const { return order_; }
  [[nodiscard]] std::complex<double> coefficient(int m, int n) const;
  // Returns the rms of t over a period, grey levels.
  [[nodiscard]] double contrast() const { return contrast_; }
  // Return the mean of dx^2 and dy^2 over a period, (grey levels per pitch)^2. Divided by the noise variance, this is a
  // pixel's Fisher information about a shift.
  [[nodiscard]] double slope_power_x() const { return slope_power_[0]; }
  [[nodiscard]] double slope_power_y() const { return slope_power_[1]; }

 protected:
  [[nodiscard]] const std::vector<std::complex<double>>& series() const { return series_; }

 private:
  int order_ = 0;
  std::vector<std::complex<double>> series_;
  double contrast_ = 0.0;
  std::array<double, 2> slope_power_{};
};

// Series with the table of its nodes, which takes longer to make than all the rest.
class PrintTemplate : public PrintSeries {
 public:
  // Makes the table. Its error is 1e-2 of the highest harmonic (2e-5 of a lone fundamental) for t. For its slopes it is
  // 8 % (0.1 %).
  explicit PrintTemplate(PrintSeries series);
  PrintTemplate(int order, std::span<const std::complex<double>> series);

  // Returns a template of the fundamentals only: amplitude_x cos(2 pi X) + amplitude_y cos(2 pi Y).
  [[nodiscard]] static PrintTemplate cosine(double amplitude_x, double amplitude_y);

  // Returns level (grey levels) and derivatives (per pitch) at a grating coordinate (pitches).
  [[nodiscard]] PrintLevel at(PrintPoint p) const;
  [[nodiscard]] const PrintNodes& nodes() const { return nodes_; }

 private:
  PrintNodes nodes_;
};

// Returns the series of a grating of lines: its mean along them. `changes_along_x`: its levels change along x, otherwise
// along y.
[[nodiscard]] PrintSeries averaged_along_lines(const PrintSeries& print, bool changes_along_x);

// Returns the highest order that pixels resolve at this pitch, at least 1. Beyond P / 2.2, harmonics fold onto lower
// ones.
[[nodiscard]] int highest_order(double pitch_px);

}  // namespace moiregauge::internal
