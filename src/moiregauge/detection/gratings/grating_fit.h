// SPDX-License-Identifier: Apache-2.0
// Model of a grating in an image: a projective lattice with a Fourier series on it, fitted to grey levels.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "moiregauge/image/image.h"
#include "moiregauge/units/point.h"

namespace moiregauge::internal {

// Map from image points to positions in periods: phi = (k1 . x, k2 . x) / (1 + q . x), with x in px from `origin`.
struct Lattice {
  ImagePoint origin;                            // px
  Eigen::Matrix2d k = Eigen::Matrix2d::Zero();  // rows k1, k2, cycles per px
  Eigen::Vector2d q{0, 0};                      // per px
  bool lines = false;                           // grey varies along phi1 only; k2 is k1 rotated by 90 degrees
  [[nodiscard]] Eigen::Vector2d phi(ImagePoint p) const;
  [[nodiscard]] ImagePoint at(const Eigen::Vector2d& phi) const;
  [[nodiscard]] Eigen::Matrix2d jacobian(ImagePoint p) const;  // d phi / d px
};

// Fourier series on a lattice: grey(phi) = mean + sum over harmonics (m, n) of c cos + s sin. In the image a linear
// change of light is added to it.
struct LatticeModel {
  Lattice lattice;
  std::vector<Eigen::Vector2i> harmonics;
  Eigen::VectorXd coefficients;                                 // grey levels: mean, then c and s of every harmonic
  Eigen::Vector2d slope{0, 0};                                  // grey levels per px
  double sigma = 0.0;                                           // grey levels, rms of the series without its mean
  double residual = 0.0;                                        // grey levels, rms
  [[nodiscard]] double grey(const Eigen::Vector2d& phi) const;  // without the slope
  [[nodiscard]] double amplitude(int m, int n) const;           // grey levels; 0 for a harmonic outside the series
  // Returns the share of the grey levels' variance that the series explains.
  [[nodiscard]] double explained() const;
};

// Rectangle on the grating, in pitches along the grating's own axes.
struct PhiBox {
  Eigen::Vector2d low{0, 0};
  Eigen::Vector2d high{0, 0};
};

inline constexpr int kHighestOrder = 3;  // for the harmonics along either axis

struct LatticeFitOptions {
  int order = 1;                   // highest harmonic, 1 to kHighestOrder
  bool perspective = false;        // fits q too
  std::size_t most_pixels = 2000;  // limit; a larger box is sampled at stratified points
};

// Fits the series and the lattice to the pixels in `box`, which should hold at least two periods. `to_phi` maps the
// axes of the box (those of the grating) to phi. The weight of the pixels decreases towards the sides of the box
// (Hann), so an unknown edge of the grating does little harm there. Returns false if the pixels do not determine the
// lattice. Error: harmonics outside the series change the lattice by at most 1e-4.
[[nodiscard]] bool fit_lattice(const Image<float>& grey, const PhiBox& box, const Eigen::Matrix2d& to_phi,
                               const LatticeFitOptions& options, LatticeModel& model);

// Returns the grey level at p by bilinear interpolation; NaN outside the image.
[[nodiscard]] double grey_at(const Image<float>& grey, ImagePoint p);

}  // namespace moiregauge::internal
