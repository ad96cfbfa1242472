// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/observation/raster/lines_region.h"

#include <algorithm>
#include <vector>

#include "moiregauge/units/units.h"

namespace moiregauge::internal {
namespace {

// Share of the largest modulation. At the end of the grating under the window's triangle it is one half.
constexpr double kAlive = 0.5;

// Returns the mean modulus across the lines at every step along them.
std::vector<double> profile(const Image<std::complex<double>>& fringe, bool lines_along_y) {
  std::vector<double> out(static_cast<std::size_t>(lines_along_y ? fringe.height() : fringe.width()), 0.0);
  for (int y = 0; y < fringe.height(); ++y) {
    for (int x = 0; x < fringe.width(); ++x)
      out[static_cast<std::size_t>(lines_along_y ? y : x)] += std::abs(fringe.at(x, y));
  }
  return out;
}

struct Run {
  int first = 0, length = 0;
};

Run longest_alive(const std::vector<double>& modulus) {
  const double least = kAlive * *std::max_element(modulus.begin(), modulus.end());
  Run best, run;
  for (int i = 0; i < static_cast<int>(modulus.size()); ++i) {
    run = modulus[static_cast<std::size_t>(i)] >= least ? Run{run.first, run.length + 1} : Run{i + 1, 0};
    if (run.length > best.length) best = run;
  }
  return best;
}

}  // namespace

LinesRegion region_mean_of_lines(const FringeField& field, Axis axis) {
  const int side = std::max(field.fringe.width(), field.fringe.height());
  LinesRegion out{region_mean(field, axis, kNoCarrier, side), 1.0};
  if (out.phase.valid || field.fringe.width() < 1 || field.fringe.height() < 1) return out;
  const bool along_y = axis == Axis::kX;
  const int whole = along_y ? field.fringe.height() : field.fringe.width();
  const Run run = longest_alive(profile(field.fringe, along_y));
  if (run.length >= whole || run.length < field.sampling_pitch_px) return out;
  FringeField part{along_y ? Image<std::complex<double>>(field.fringe.width(), run.length)
                           : Image<std::complex<double>>(run.length, field.fringe.height()),
                   field.margin, field.sampling_pitch_px};
  for (int y = 0; y < part.fringe.height(); ++y) {
    for (int x = 0; x < part.fringe.width(); ++x)
      part.fringe.at(x, y) = along_y ? field.fringe.at(x, y + run.first) : field.fringe.at(x + run.first, y);
  }
  RegionPhase phase = region_mean(part, axis, kNoCarrier, side);
  const double off_middle = run.first + 0.5 * (run.length - 1) - 0.5 * (whole - 1);
  phase.phase_rad =
      wrapped(phase.phase_rad - off_middle * (along_y ? phase.gradient_y_rad_per_px : phase.gradient_x_rad_per_px));
  return {phase, static_cast<double>(run.length) / whole};
}

}  // namespace moiregauge::internal
