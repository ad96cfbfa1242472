// SPDX-License-Identifier: Apache-2.0
// Learning a print's template from pixels whose print coordinates are known.
#pragma once

#include <complex>
#include <optional>
#include <vector>

#include "moiregauge/phase/fit/print_template.h"

namespace moiregauge::internal {

// Grey levels summed over bins of one pitch in both directions. The fractions of a pitch at which pixels fall fill
// them.
class PrintBins {
 public:
  explicit PrintBins(int order);
  void add(PrintPoint p, double grey);
  // The series that fits the bins' means best, each counted by its pixels (least squares; the bins' width is taken
  // out). The level is that of the pixels: c(0, 0) is dropped. Nothing when the bins do not determine it (too few
  // pixels, or a pitch of a whole few pixels seen upright).
  [[nodiscard]] std::optional<PrintTemplate> fit() const;
  [[nodiscard]] long pixels() const { return pixels_; }

 private:
  int order_;
  int side_;
  long pixels_ = 0;
  std::vector<double> count_, sum_;  // side x side, y slowest
};

}  // namespace moiregauge::internal
