// SPDX-License-Identifier: Apache-2.0
// Where in a picture a grating's lattice is to be seen: cells of half a pitch, each a number from 0 (not at all) to
// about 1.
#pragma once

#include <complex>
#include <functional>
#include <optional>
#include <vector>

#include "moiregauge/geometry/view.h"
#include "moiregauge/image/image.h"
#include "moiregauge/phase/fit/patch_fit.h"
#include "moiregauge/site/site.h"

namespace moiregauge::internal {

// Along which of its own axes a print's grey level varies.
struct Axes {
  bool x = true;
  bool y = true;
};
[[nodiscard]] Axes axes_of(const Grating& grating);

// One cell: how much of the lattice it shows, and both fundamentals' amplitudes against the nominal lattice.
struct Presence {
  double strength = 0.0;
  std::complex<double> first, second;
};

class VisibilityMap {
 public:
  VisibilityMap(PrintPoint low, int columns, int rows, bool diagonal)
      : low_(low), columns_(columns), rows_(rows), diagonal_(diagonal) {
    cells_.resize(static_cast<std::size_t>(columns * rows));
  }
  // The cell whose middle is `low` + (i, j) / 2 pitches.
  [[nodiscard]] Presence& at(int i, int j) { return cells_[static_cast<std::size_t>(j * columns_ + i)]; }
  // The cells with their middle in the window, displaced by (i, j) half pitches. What lies outside the map counts as
  // absent.
  [[nodiscard]] double sum(const PatchWindow& window, int i, int j) const;
  [[nodiscard]] std::vector<double> cells(const PatchWindow& window, int i, int j) const;
  // The lattice seen there, from how the fundamentals' phases change from cell to cell: the print's own coordinates as
  // a linear function of the map's about the window's middle. Good to some per cents where scale or shear are off by a
  // quarter. An axis that the print does not show stays as it is.
  [[nodiscard]] PrintFromPrint lattice(const PatchWindow& window, int i, int j, Axes axes) const;

 private:
  struct Span {
    int i0, j0, i1, j1;  // cells, ends included
  };
  [[nodiscard]] Span span_of(const PatchWindow& window, int i, int j) const;

  PrintPoint low_;
  int columns_, rows_;
  bool diagonal_;
  std::vector<Presence> cells_;
};

// Does this pixel show something that is known not to be the print?
using IsHidden = std::function<bool(ImagePoint)>;

// The cells within `pitches` of a print's window, the print's coordinates being `correction` times those that the view
// has for it standing `moved` from where the site has it. A cell looks at one pitch round its middle: the amplitudes of
// the fundamentals there against the mean grey level (their geometric mean over both axes, so that a mere edge counts
// nothing). Cells beyond the picture's edge, or with anything hidden, show nothing. Empty when the window itself does
// not lie before the camera.
[[nodiscard]] std::optional<VisibilityMap> presence_round(const LumaView& luma, const View& view,
                                                          const Grating& grating, const PatchWindow& window,
                                                          Extent<frame::Board> moved, const PrintFromPrint& correction,
                                                          int pitches, const IsHidden& is_hidden = {});

}  // namespace moiregauge::internal
