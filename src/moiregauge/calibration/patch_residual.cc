// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/calibration/patch_residual.h"

#include <Eigen/Eigenvalues>

namespace moiregauge {

PatchResidual::PatchResidual(const PatchFit& fit, const Grating& grating)
    : fit_(fit),
      x_mm_(grating.centre.x),
      y_mm_(grating.centre.y),
      angle_rad_(grating.angle_rad),
      pitch_mm_(grating.pitch_mm) {
  // How print coordinates change with pixels, from the points themselves.
  const auto map = fit_homography<frame::Print, frame::Image>(std::span<const ImagePoint>(fit.image),
                                                              std::span<const PrintPoint>(fit.print));
  for (std::size_t n = 0; n < kPatchPoints; ++n)
    pitches_per_px_[n] = map ? map->jacobian(fit.image[n]) : Eigen::Matrix2d(Eigen::Matrix2d::Zero());
  const Eigen::SelfAdjointEigenSolver<PatchInformation> eigen(fit.information);
  root_ = eigen.eigenvalues().cwiseMax(0.0).cwiseSqrt().asDiagonal() * eigen.eigenvectors().transpose();
}

}  // namespace moiregauge
