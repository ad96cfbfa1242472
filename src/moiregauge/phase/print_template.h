// SPDX-License-Identifier: Apache-2.0
// One period of a print as the camera sees it: grey levels as a Fourier series over the pitch in both directions, in
// which a binary print's harmonics and cross terms, rounded by lens and pixel, are all contained.
#pragma once

#include <complex>
#include <span>
#include <vector>

#include <tl/expected.hpp>

#include "moiregauge/units/point.h"

namespace moiregauge {

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

// t(X, Y) = sum over |m|, |n| <= order of c(m, n) exp(2 pi i (m X + n Y)), real, without its mean (c(0, 0) = 0).
class PrintTemplate {
 public:
  // `series`: (2 order + 1)^2 coefficients, n slowest, both from -order; made real by symmetry. The series is tabulated
  // on a grid so fine that the cubic look-up errs by less than 1e-3 of the highest harmonic, 2e-5 of a lone first.
  PrintTemplate(int order, std::span<const std::complex<double>> series);

  // The first harmonics only: amplitude_x cos(2 pi X) + amplitude_y cos(2 pi Y).
  [[nodiscard]] static PrintTemplate cosine(double amplitude_x, double amplitude_y);

  [[nodiscard]] PrintLevel at(PrintPoint p) const;
  [[nodiscard]] int order() const { return order_; }
  [[nodiscard]] std::complex<double> coefficient(int m, int n) const;
  // Rms of t over a period, grey levels.
  [[nodiscard]] double contrast() const;
  // Mean of dx^2 and dy^2 over a period: what a pixel tells of a shift (grey levels per pitch, squared).
  [[nodiscard]] double slope_power_x() const;
  [[nodiscard]] double slope_power_y() const;

 private:
  int order_ = 0;
  int side_ = 0;  // of the table
  std::vector<std::complex<double>> series_;
  // side x side, wrapped by one row and column before and two after. The second derivatives have their own: those of
  // the look-up's cubics jump from cell to cell.
  std::vector<float> table_, table_xx_, table_yy_;
};

// The highest order that pixels carry for a pitch of so many px: beyond P / 2.2 harmonics fold back onto lower ones.
[[nodiscard]] int highest_order(double pitch_px);

}  // namespace moiregauge
