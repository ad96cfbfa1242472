// SPDX-License-Identifier: Apache-2.0
// Uncertainty budget of `precise`: the causes of u of a target's displacement.
#pragma once

#include "moiregauge/calibration/scene/frame_fit.h"
#include "moiregauge/displacement/camera_pose.h"
#include "moiregauge/displacement/sample.h"

namespace moiregauge::internal {

class PreciseBudget {
 public:
  // `scene`: covariance of all scene parameters.
  // `then`: fit of the reference frame.
  // `u_readout_s`: of a rolling shutter's readout time.
  PreciseBudget(const Site& site, Eigen::MatrixXd scene, FrameFit then, double u_readout_s = 0.0);

  // Returns the budget of `now` minus the reference frame, for a displacement of `moved` mm.
  [[nodiscard]] Budget budget(const FrameFit& now, std::size_t marker, Extent<frame::Board> moved) const;
  // Returns the same for compressed footage. `now` and the reference frame include the codec's error, the fits by noise
  // do not. The difference of both is the codec's part.
  [[nodiscard]] Budget budget(const FrameFit& now, const FrameFit& now_by_noise, const FrameFit& then_by_noise,
                              std::size_t marker, Extent<frame::Board> moved) const;
  // Returns the camera pose of a frame. Its uncertainty includes the noise of the frame and that of the scene.
  [[nodiscard]] CameraPose pose(const FrameFit& now) const;
  [[nodiscard]] const FrameFit& then() const { return then_; }

 private:
  struct Share;
  [[nodiscard]] Share share(const Eigen::RowVectorXd& k, std::size_t marker, double across_mm) const;

  Eigen::MatrixXd scene_;
  FrameFit then_;
  double u_readout_s_;
  double u_axis_rad_ = 0.0;  // direction of the board's axes, rad
};

// Returns the factor by which the frame's variance exceeds the stated noise, at least 1.
[[nodiscard]] double inflation(const FrameFit& fit);

// Returns the root of the sum of squares of all parts, mm.
[[nodiscard]] Extent<frame::Board> total(const Budget& budget);

}  // namespace moiregauge::internal
