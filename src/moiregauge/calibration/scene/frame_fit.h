// SPDX-License-Identifier: Apache-2.0
// Fit of one frame to a fixed scene: camera pose and target shifts, and their sensitivity to the scene.
#pragma once

#include "moiregauge/calibration/scene/bundle.h"

namespace moiregauge::internal {

inline constexpr int kMaxPose = 6 + kMotionParameters;  // pose, and motion of a rolling shutter

// Scene parameters that a grating's points depend on: those that all markers share, and its own.
inline constexpr int kOwnParameters = kCommonParameters + kShapeParameters;

// Shift of one target. Targets are connected through the pose only, so a frame's work grows linearly with their number.
struct ShiftPart {
  std::size_t marker = 0;
  Eigen::Matrix2d covariance;                                        // with the pose known, mm^2
  Eigen::Matrix<double, 2, kOwnParameters> by_own;                   // change per own parameter, with the pose fixed
  Eigen::Matrix<double, 2, Eigen::Dynamic, 0, 2, kMaxPose> by_pose;  // change per unit of pose (and motion)
};

// Information about a marker's own parameters.
struct OwnInformation {
  std::size_t marker = 0;
  Eigen::Matrix<double, kOwnParameters, kOwnParameters> information;
};

// A sample does not need the information about the scene.
enum class FrameDetail { kSamples, kScene };

struct FrameFit {
  bool ok = false;
  Pose pose;
  std::vector<Extent<frame::Board>> shift;  // one per site marker, mm; NaN if not read
  std::vector<int> shift_row;               // row of a marker's shift in the matrices below; -1: none
  // Variance of pose (6: rad^2, mm^2) and shifts (mm^2), from this frame's noise alone.
  Eigen::VectorXd variance;
  // Change of pose (and motion) per unit of each scene parameter.
  Eigen::MatrixXd pose_sensitivity;
  std::vector<ShiftPart> shift_parts;  // one per shift, in the order of the rows
  Eigen::MatrixXd pose_covariance;     // for pose and motion
  // Only with FrameDetail::kScene: normal equations of pose and motion with the scene, and of each marker's own
  // parameters, after eliminating the shifts.
  Eigen::MatrixXd by_scene;
  std::vector<OwnInformation> own_scene;         // one per marker that was read
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
  // `scene_by_readout`: information between each scene parameter and the readout time, with pose, motion and shifts
  // eliminated. `scene_slope`: half the derivative of chi2 by each scene parameter. Both only with FrameDetail::kScene.
  Eigen::VectorXd of_motion, by_readout, scene_by_readout, scene_slope;
  double readout_information = 0.0, readout_slope = 0.0;
};

// Returns the number of scene parameters: 9, and 7 per marker.
[[nodiscard]] int scene_parameters(std::size_t markers);

// Fits the camera pose and the target shifts of one frame to a fixed scene (at most four Gauss-Newton steps from
// frame.pose and frame.shift). With a RowDesign the twelve motion parameters are fitted, too, in the last rows of the covariance.
// Units: pose rad and mm, shifts mm on the board.
// Fails (ok = false): fewer than three references were read, or the gratings do not determine the pose.
// Error: `variance` holds this frame's noise, `pose_sensitivity` and `shift_parts` the change per scene parameter. An
// axis that the grating does not show keeps its start value, with u = kUnknownShift.
[[nodiscard]] FrameFit fit_frame(const Site& site, const Scene& scene, const BundleFrame& frame,
                                 FrameDetail detail = FrameDetail::kScene);

// Return the covariance of a target's shift (mm^2), and its change per unit of each scene parameter. The target must
// have a shift.
[[nodiscard]] Eigen::Matrix2d shift_covariance(const FrameFit& fit, std::size_t marker);
[[nodiscard]] Eigen::MatrixXd shift_sensitivity(const FrameFit& fit, std::size_t marker);

// Return the covariance of pose, shifts and motion, and their change per unit of each scene parameter. These matrices
// grow with the square of the number of targets.
[[nodiscard]] Eigen::MatrixXd full_covariance(const FrameFit& fit);
[[nodiscard]] Eigen::MatrixXd full_sensitivity(const FrameFit& fit);

// Adds the frame's information about the scene parameters, after eliminating pose and shifts.
void add_scene_information(const FrameFit& fit, Eigen::MatrixXd& information);

// Returns the covariance of the scene parameters, from the frames' information and the priors. Parameters outside the
// model have zero rows.
[[nodiscard]] Eigen::MatrixXd scene_covariance(const Site& site, std::span<const FrameFit> frames,
                                               const ScenePrior& prior, const SceneModel& model);

}  // namespace moiregauge::internal
