// SPDX-License-Identifier: Apache-2.0
// Fit of one frame to a fixed scene: camera pose and target shifts, and their sensitivity to the scene.
#pragma once

#include "moiregauge/calibration/scene/bundle.h"

namespace moiregauge::internal {

struct FrameFit {
  bool ok = false;
  Pose pose;
  std::vector<Extent<frame::Board>> shift;       // one per site marker, mm; NaN if not read
  std::vector<int> shift_row;                    // row of a marker's shift in the matrices below; -1: none
  Eigen::MatrixXd covariance;                    // for pose (6: rad, mm) and shifts (mm), from this frame's noise alone
  Eigen::MatrixXd sensitivity;                   // change of pose and shifts per unit of each scene parameter
  Eigen::MatrixXd scene_information;             // about the scene parameters, after eliminating pose and shifts
  std::vector<Eigen::Matrix2d> own_information;  // about each marker's shift with the pose known, 1/mm^2
  std::vector<double> chi2;                      // one per site marker
  double chi2_sum = 0.0;
  long dof = 0;
  // Rolling shutter only, otherwise empty or zero.
  // `motion`: deviation from the expected motion. `of_motion`: part of the covariance's diagonal that this motion
  // causes.
  // `by_readout`: change of pose and shifts per second of readout time.
  // `readout_information`: in 1/s^2. `readout_slope`: half the derivative of chi2 by the readout time, 1/s.
  Motion motion = Motion::Zero();
  Eigen::VectorXd of_motion, by_readout;
  double readout_information = 0.0, readout_slope = 0.0;
};

// Returns the number of scene parameters: 9, and 5 per marker.
[[nodiscard]] int scene_parameters(std::size_t markers);

// Fits the camera pose and the target shifts of one frame to a fixed scene (four Gauss-Newton steps from frame.pose and
// frame.shift). With a RowDesign the twelve motion parameters are fitted, too, in the last rows of the covariance.
// Units: pose rad and mm, shifts mm on the board.
// Fails (ok = false): fewer than three references were read, or the gratings do not determine the pose.
// Error: `covariance` holds this frame's noise, `sensitivity` the change per scene parameter. An axis that the grating
// does not show keeps its start value, with u = kUnknownShift.
[[nodiscard]] FrameFit fit_frame(const Site& site, const Scene& scene, const BundleFrame& frame);
inline constexpr double kUnknownShift = 1e4;  // mm

// Returns the covariance of the scene parameters, from the frames' information and the priors. Parameters outside the
// model have zero rows.
[[nodiscard]] Eigen::MatrixXd scene_covariance(const Site& site, std::span<const FrameFit> frames,
                                               const ScenePrior& prior, const SceneModel& model);

}  // namespace moiregauge::internal
