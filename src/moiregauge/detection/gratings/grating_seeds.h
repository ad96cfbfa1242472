// SPDX-License-Identifier: Apache-2.0
// Where a picture is locally periodic: spectra of small tiles at several scales.
#pragma once

#include <vector>

#include <Eigen/Dense>

#include "moiregauge/image/image.h"
#include "moiregauge/units/point.h"

namespace moiregauge::internal {

// A tile whose spectrum is one lattice.
struct LatticeSeed {
  ImagePoint centre;         // px
  Eigen::Vector2d k1{0, 0};  // fundamental harmonics, cycles per px
  Eigen::Vector2d k2{0, 0};  // zero: lines only
  double score = 0.0;        // share of the grey levels' variance about the centre that it explains
};

// Seeds by the kind of print, each list best first.
struct LatticeSeeds {
  std::vector<LatticeSeed> plain;
  std::vector<LatticeSeed> thin_lines;  // grids of lines thinner than a third of the pitch; some are in `plain` too
};

// Finds the tile of each neighbourhood that is a lattice and hardly anything else. min_modulation: grey levels, below
// which a tile counts as flat.
[[nodiscard]] LatticeSeeds find_lattice_seeds(const Image<float>& grey, double min_modulation);

}  // namespace moiregauge::internal
