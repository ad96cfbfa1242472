// SPDX-License-Identifier: Apache-2.0
// One period of a print as the camera sees it: grey levels as a Fourier series over the pitch in both directions, in
// which a binary print's harmonics and cross terms, rounded by lens and pixel, are all contained.
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
struct Print;  // pitches along a print's own two axes, x to the right and y up when the print hangs upright; 0: its
               // symmetry point
}
using PrintPoint = Point<frame::Print>;

// Grey level and its derivatives by pitches.
struct PrintLevel {
  double t = 0.0;
  double dx = 0.0;
  double dy = 0.0;
  double dxx = 0.0;
  double dyy = 0.0;
};

// The period on a grid of nodes, each with the Taylor series of second order round it: from the nearest node t and its
// slopes are read without neighbours, continuous to the error of the series. Six coefficients of 16 bits, two to a
// word, in the order of kNodePowers; coefficient k is its 16 bits times scale[k]. In units of the distance between nodes.
struct PrintNodes {
  static constexpr int kWords = 3;
  int side = 0;  // nodes to a pitch; the table holds one more to every side
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

// t(X, Y) = sum over |m|, |n| <= order of c(m, n) exp(2 pi i (m X + n Y)), real, without its mean (c(0, 0) = 0).
class PrintTemplate {
 public:
  // `series`: (2 order + 1)^2 coefficients, n slowest, both from -order; made real by symmetry. The nodes lie so close
  // that t errs by less than 1e-2 of the highest harmonic, 2e-5 of a lone first; its slopes by 8 % and 0.1 %.
  PrintTemplate(int order, std::span<const std::complex<double>> series);

  // The first harmonics only: amplitude_x cos(2 pi X) + amplitude_y cos(2 pi Y).
  [[nodiscard]] static PrintTemplate cosine(double amplitude_x, double amplitude_y);

  [[nodiscard]] PrintLevel at(PrintPoint p) const;
  [[nodiscard]] const PrintNodes& nodes() const { return nodes_; }
  [[nodiscard]] int order() const { return order_; }
  [[nodiscard]] std::complex<double> coefficient(int m, int n) const;
  // Rms of t over a period, grey levels.
  [[nodiscard]] double contrast() const { return contrast_; }
  // Mean of dx^2 and dy^2 over a period: what a pixel tells of a shift (grey levels per pitch, squared).
  [[nodiscard]] double slope_power_x() const { return slope_power_[0]; }
  [[nodiscard]] double slope_power_y() const { return slope_power_[1]; }

 private:
  int order_ = 0;
  std::vector<std::complex<double>> series_;
  PrintNodes nodes_;
  double contrast_ = 0.0;
  std::array<double, 2> slope_power_{};
};

// The highest order that pixels carry for a pitch of so many px: beyond P / 2.2 harmonics fold back onto lower ones.
[[nodiscard]] int highest_order(double pitch_px);

}  // namespace moiregauge::internal
