// SPDX-License-Identifier: Apache-2.0
// Rotation of every target in its own plane, in one frame of a solved scene.
#pragma once

#include "moiregauge/calibration/scene/frame_fit.h"

namespace moiregauge::internal {

struct FrameRotations {
  std::vector<int> row;         // row of a marker's rotation in the vectors and matrices below; -1: none
  Eigen::VectorXd angle_rad;    // counter-clockwise, relative to the site's angle
  Eigen::MatrixXd covariance;   // from this frame's noise, rad^2
  Eigen::MatrixXd sensitivity;  // change per unit of each scene parameter
  Eigen::VectorXd by_readout;   // change per second of readout time, rad/s; empty: global shutter
};

// Fits one rotation per target to the residuals that `fit` leaves, with pose and shifts free (Frisch and Waugh 1933).
// The result equals that of a common fit to first order in the angle.
// `frame`, `fit`: a frame and its fit in this scene.
// Fails (row -1): the target was not read, or its grating does not show a rotation.
// Error: the covariance is that of the stated noise, increased if chi2 exceeds its degrees of freedom. It is
// uncorrelated with the shifts of `fit`, because the residuals of a least squares fit are uncorrelated with its unknowns.
[[nodiscard]] FrameRotations fit_rotations(const Site& site, const Scene& scene, const BundleFrame& frame,
                                           const FrameFit& fit);

}  // namespace moiregauge::internal
