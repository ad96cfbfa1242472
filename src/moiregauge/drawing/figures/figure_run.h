// SPDX-License-Identifier: Apache-2.0
// Draws the figures of a run for a paper: one column wide, letters of 8 points, vectors if the format supports them.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "moiregauge/drawing/surface/canvas.h"
#include "moiregauge/results/camera_motion.h"
#include "moiregauge/results/peaks.h"

namespace moiregauge::internal::figure {

// Results of a run. All of them must outlive the figures.
struct RunFound {
  const Reference& reference;
  const Observations& observations;
  const Samples& samples;
  const std::optional<Scene>& scene;
  ImageView<std::uint8_t> picture;  // reference frame; empty: no overlay
};

struct NamedFigure {
  std::string name;  // file name without extension
  Figure figure;
};

struct RunFigures {
  std::vector<NamedFigure> figures;
  std::vector<std::string> excluded;  // "spectrum (reason)"
};

// Returns four figures.
// The displacement figure shows x and y over time with the band of U (k = 2), interrupted at gaps. Values of rows that
// are not `ok` are open grey dots.
// The spectrum figure shows the one-sided PSD of both axes with marked peaks.
// The camera figure shows its shift and rotation.
// The overlay figure shows the markers in the reference frame.
[[nodiscard]] RunFigures run_figures(const RunFound& found);

// Largest number of points of a curve, apart from gaps: more than a printed column can show. A longer curve is divided
// into bins, and each bin is drawn by its lowest and highest point.
inline constexpr std::size_t kMaxPointsDrawn = 2400;

struct Curve {
  std::vector<double> x, y, low, high;  // low, high: limits of the band; same length as y, NaN is a gap
};
[[nodiscard]] Curve thinned(const Curve& curve, std::size_t most = kMaxPointsDrawn);

}  // namespace moiregauge::internal::figure
