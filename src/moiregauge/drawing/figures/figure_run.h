// SPDX-License-Identifier: Apache-2.0
// The figures of a run, as a paper wants them: one column wide, letters of 8 points, vectors where the format has them.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "moiregauge/drawing/surface/canvas.h"
#include "moiregauge/results/camera_motion.h"
#include "moiregauge/results/peaks.h"

namespace moiregauge::internal::figure {

// What a run found; all of it must outlive the figures.
struct RunFound {
  const Reference& reference;
  const Observations& observations;
  const Samples& samples;
  const std::optional<Scene>& scene;
  ImageView<std::uint8_t> picture;  // the reference frame; without pixels: no overlay
};

struct NamedFigure {
  std::string name;  // of the file, without its ending
  Figure figure;
};

struct RunFigures {
  std::vector<NamedFigure> figures;
  std::vector<std::string> left_out;  // "spectrum: why", in words
};

// displacement: x and y against time with the 95 % band (1.96 u), gaps as gaps; spectrum: the one-sided PSD of both
// axes, peaks marked; camera: how it shifted and turned; overlay: the markers in the reference frame.
[[nodiscard]] RunFigures run_figures(const RunFound& found);

// The longest a curve may be: beyond it every bin of neighbours is drawn by its lowest and highest. More points than
// that no column can show.
inline constexpr std::size_t kMaxPointsDrawn = 2400;

struct Curve {
  std::vector<double> x, y, low, high;  // low and high: of the band; all of one length, NaN is a gap
};
[[nodiscard]] Curve thinned(const Curve& curve, std::size_t most = kMaxPointsDrawn);

}  // namespace moiregauge::internal::figure
