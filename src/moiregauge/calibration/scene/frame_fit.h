// SPDX-License-Identifier: Apache-2.0
// One frame against a scene that is held fixed: the camera's pose and the targets' shifts, and how they would follow if
// the scene were different.
#pragma once

#include "moiregauge/calibration/scene/bundle.h"

namespace moiregauge::internal {

struct FrameFit {
  bool ok = false;
  Pose pose;
  std::vector<Extent<frame::Board>> shift;  // one per site marker, mm; NaN where not read
  std::vector<int> shift_row;               // row of a marker's shift in what follows; -1: none
  Eigen::MatrixXd covariance;               // of pose (6) and shifts, from this frame's noise alone
  Eigen::MatrixXd sensitivity;              // their change per unit of each of the scene's parameters
  Eigen::MatrixXd scene_information;  // what the frame tells of the scene's parameters, pose and shifts eliminated
  std::vector<Eigen::Matrix2d> own_information;  // of each marker's shift, the pose known; one per site marker
  std::vector<double> chi2;                      // one per site marker
  double chi2_sum = 0.0;
  long dof = 0;
  // Of a rolling shutter, else empty or zero: the motion otherwise than expected; what of the covariance's diagonal is
  // due to it; how pose and shifts follow the readout; what the frame tells of the readout (information and half the
  // slope of chi2, per second).
  Motion motion = Motion::Zero();
  Eigen::VectorXd of_motion, by_readout;
  double readout_information = 0.0, readout_slope = 0.0;
};

[[nodiscard]] int scene_parameters(std::size_t markers);  // 9 + 5 per marker

// Of a frame with RowDesign the covariance has twelve rows more, behind the shifts: those of the motion.
// A fixed number of Gauss-Newton passes from frame.pose and frame.shift. A target's shift along an axis that its print
// does not show stays where it starts, with kUnknownShift as its standard uncertainty.
[[nodiscard]] FrameFit fit_frame(const Site& site, const Scene& scene, const BundleFrame& frame);
inline constexpr double kUnknownShift = 1e4;  // mm

// Covariance of the scene's parameters from the frames' information and the priors of what the model leaves free.
[[nodiscard]] Eigen::MatrixXd scene_covariance(const Site& site, std::span<const FrameFit> frames,
                                               const ScenePrior& prior, const SceneModel& model);

}  // namespace moiregauge::internal
