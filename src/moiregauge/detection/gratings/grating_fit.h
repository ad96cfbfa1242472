// SPDX-License-Identifier: Apache-2.0
// A periodic print as a projective lattice with a Fourier series on it, fitted to grey levels.
#pragma once

#include <vector>

#include <Eigen/Dense>

#include "moiregauge/image/image.h"
#include "moiregauge/units/point.h"

namespace moiregauge::internal {

// Position in periods: phi = (k1 . x, k2 . x) / (1 + q . x), x = px from `origin`.
struct Lattice {
  ImagePoint origin;
  Eigen::Matrix2d k = Eigen::Matrix2d::Zero();  // rows k1, k2, cycles per px
  Eigen::Vector2d q{0, 0};                      // per px
  bool lines = false;                           // grey varies along phi1 only; k2 is k1 turned by 90 degrees
  [[nodiscard]] Eigen::Vector2d phi(ImagePoint p) const;
  [[nodiscard]] ImagePoint at(const Eigen::Vector2d& phi) const;
  [[nodiscard]] Eigen::Matrix2d jacobian(ImagePoint p) const;  // d phi / d px
};

// grey(phi) = mean + sum over harmonics (m, n) of c cos + s sin; in the picture a slope of light is added to it.
struct LatticeModel {
  Lattice lattice;
  std::vector<Eigen::Vector2i> harmonics;
  Eigen::VectorXd coefficients;  // mean, then c and s of every harmonic
  Eigen::Vector2d slope{0, 0};   // grey levels per px
  double sigma = 0.0;            // grey levels, rms of the model's variation
  double residual = 0.0;         // rms of what is left
  [[nodiscard]] double grey(const Eigen::Vector2d& phi) const;
  [[nodiscard]] double amplitude(int m, int n) const;
  // Of the grey levels' variance, by the series.
  [[nodiscard]] double explained() const;
};

// A rectangle of the print, in the print's pitches.
struct PhiBox {
  Eigen::Vector2d low{0, 0};
  Eigen::Vector2d high{0, 0};
};

inline constexpr int kHighestOrder = 3;  // of the harmonics along either axis

// Fits a series of harmonics up to `order` (1 to kHighestOrder) and the lattice itself to the pixels in the box, which
// should hold two periods or more. `to_phi` turns the box's axes (the print's) into phi. The pixels weigh less towards
// the box's sides (Hann): edges of the print that are not yet known do no harm there, and the harmonics that are not
// modelled leak no more than 1e-4 into the lattice. Returns false when the pixels do not determine it.
struct LatticeFitOptions {
  int order = 1;
  bool perspective = false;
  std::size_t most_pixels = 2000;  // of a larger box, evenly strewn ones
};
[[nodiscard]] bool fit_lattice(const Image<float>& grey, const PhiBox& box, const Eigen::Matrix2d& to_phi,
                               const LatticeFitOptions& options, LatticeModel& model);

// By bilinear interpolation; NaN outside.
[[nodiscard]] double grey_at(const Image<float>& grey, ImagePoint p);

}  // namespace moiregauge::internal
