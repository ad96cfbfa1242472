// SPDX-License-Identifier: Apache-2.0
// Persistent error: what the residuals of a print have in common in all frames. Rough ink, an imperfect template and a
// lens beyond the model do that. It does not average over frames, so lens and places are known less well than by noise.
#pragma once

#include <span>

#include "moiregauge/calibration/model/calibrate.h"

namespace moiregauge::internal {

// Returns the persistent error (k = 1) of each coordinate of the references' points, mm. It is the mean square of each
// point's mean residual, less what noise leaves of it, for the degrees of freedom that the solution leaves.
// `fits`: of the solution's frames. `covariance`: of the scene.
// Returns 0 below four frames, and if noise explains the mean residuals.
[[nodiscard]] double persistent_error_mm(const Site& site, const BundleSolution& solution,
                                         std::span<const FrameFit> fits, const Eigen::MatrixXd& covariance);

// Returns chi2 per degree of freedom of what varies in the references' places, rotations and sizes between frames. These
// are their residuals without the means over the frames, as an affine map of each print's nine points.
// Returns 0 if no reference was read in four frames.
[[nodiscard]] double chi2_dof_of_places(const Site& site, const BundleSolution& solution,
                                        std::span<const FrameFit> fits);

// Returns the covariance of a solved scene with this model, with the persistent errors that its references show. They are
// e in each coordinate of each point of a print, and e in common to all nine. Prints of targets have the same e, because
// all prints usually come from one printer.
// Model: errors e change half the slope of chi2 by G e, and the solution by C G e with its covariance C. So C becomes
// C + C G E G^T C, with E the covariance of e (the sandwich of Huber, 1967).
[[nodiscard]] Eigen::MatrixXd covariance_with_persistent_errors(const Site& site, const Calibration& calibration,
                                                                const SceneModel& model);

}  // namespace moiregauge::internal
