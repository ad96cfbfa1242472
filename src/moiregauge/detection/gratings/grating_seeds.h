// SPDX-License-Identifier: Apache-2.0
// Detects locally periodic regions of an image by the spectra of small tiles at several scales.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "moiregauge/image/image.h"
#include "moiregauge/units/point.h"

namespace moiregauge::internal {

// Tile with the spectrum of one lattice.
struct LatticeSeed {
  ImagePoint centre;         // px
  Eigen::Vector2d k1{0, 0};  // fundamental harmonics, cycles per px
  Eigen::Vector2d k2{0, 0};  // zero: lines only
  double score = 0.0;        // share of the grey levels' variance around the centre that the lattice explains
};

// Seeds by the kind of print, each list best first.
struct LatticeSeeds {
  std::vector<LatticeSeed> plain;
  std::vector<LatticeSeed> thin_lines;  // grids of lines thinner than a third of the pitch; some are in `plain` too
};

// Finds, in each neighbourhood of tiles, the tile with the purest lattice. `min_modulation` is in grey levels: a tile
// with an rms below half of it counts as flat.
[[nodiscard]] LatticeSeeds find_lattice_seeds(const Image<float>& grey, double min_modulation);

}  // namespace moiregauge::internal
