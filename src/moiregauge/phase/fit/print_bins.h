// SPDX-License-Identifier: Apache-2.0
// Learns the template of a grating from pixels with known grating coordinates (docs/methods/precise/template.md).
#pragma once

#include <complex>
#include <optional>
#include <vector>

#include "moiregauge/phase/fit/print_template.h"

namespace moiregauge::internal {

// Grey levels summed over bins of one pitch in both directions. Pixels are at all fractions of a pitch, so they fill
// the bins.
class PrintBins {
 public:
  explicit PrintBins(int order);
  // Adds a pixel at grating coordinate `p` (pitches).
  void add(PrintPoint p, double grey);
  // Fits the Fourier series to the bins by least squares, each bin weighted by its pixels. Corrects for the width of
  // the bins and drops the mean c(0, 0). A ridge bounds coefficients that the bins do not determine. `near`: a similar
  // series, from which the iteration starts, or null.
  // Fails (nothing): fewer than four pixels per coefficient.
  [[nodiscard]] std::optional<PrintSeries> fit(const PrintSeries* near = nullptr) const;
  [[nodiscard]] long pixels() const { return pixels_; }

 private:
  int order_;
  int side_;
  long pixels_ = 0;
  struct Bin {
    double count = 0.0, sum = 0.0;
  };
  std::vector<Bin> bins_;  // side x side, y slowest
};

}  // namespace moiregauge::internal
