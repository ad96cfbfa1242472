// SPDX-License-Identifier: Apache-2.0
// A periodic print as a projective lattice with a Fourier series on it, fitted to grey levels.
#pragma once

#include <vector>

#include <Eigen/Dense>

#include "moiregauge/image/image.h"
#include "moiregauge/units/point.h"

namespace moiregauge {

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

// grey(phi) = mean + sum over harmonics (m, n) of c cos + s sin.
struct LatticeModel {
  Lattice lattice;
  std::vector<Eigen::Vector2i> harmonics;
  Eigen::VectorXd coefficients;    // mean, then c and s of every harmonic
  double sigma = 0.0;              // grey levels, of the model's variation
  double residual = 0.0;           // rms of what is left
  [[nodiscard]] double grey(const Eigen::Vector2d& phi) const;
  [[nodiscard]] double amplitude(int m, int n) const;
};

// Pixels inside a rectangle of phi space.
struct PhiBox {
  Eigen::Vector2d low{0, 0};
  Eigen::Vector2d high{0, 0};
};

// Fits a series of harmonics up to `order` and the lattice itself. `to_phi` turns the box's axes (the print's) into phi.
// Returns false when the pixels do not determine it.
[[nodiscard]] bool fit_lattice(const Image<float>& grey, const PhiBox& box, const Eigen::Matrix2d& to_phi, int order,
                               bool perspective, LatticeModel& model);

// By bilinear interpolation; NaN outside.
[[nodiscard]] double grey_at(const Image<float>& grey, ImagePoint p);

}  // namespace moiregauge
