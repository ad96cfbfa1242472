// SPDX-License-Identifier: Apache-2.0
// Joint errors of all targets in one frame of a solved scene (docs/methods/precise.md).
#pragma once

#include <vector>

#include "moiregauge/calibration/scene/frame_rotation.h"
#include "moiregauge/displacement/joint_errors.h"

namespace moiregauge::internal {

// A frame with its fit and rotations. Compressed footage: also the fit without the codec's error.
struct FittedFrame {
  FrameFit fit;
  FrameFit by_noise;
  FrameRotations rotations;
  std::vector<Extent<frame::Board>> u_motion;  // u by a target's motion and rotation, one per site marker, mm
};

class JointInScene {
 public:
  // `covariance`: of all scene parameters. `then`: the reference frame. `u_readout_s`: of the readout time.
  JointInScene(const Site& site, const Eigen::MatrixXd& covariance, FittedFrame then, double u_readout_s);

  // Returns the targets and the loadings of the reference frame, without frames.
  [[nodiscard]] JointErrors start() const;
  // Returns the errors of `now` minus the reference frame. The variance of a displacement equals the budget's.
  [[nodiscard]] FrameErrors errors_of(const FittedFrame& now) const;
  // Returns the errors of the reference frame itself: none.
  [[nodiscard]] FrameErrors zero() const;
  // Returns the errors of a frame that was not fitted.
  [[nodiscard]] FrameErrors lost() const;

 private:
  [[nodiscard]] Eigen::Index rows() const { return kQuantities * static_cast<Eigen::Index>(targets_.size()); }

  const Site& site_;
  std::vector<std::size_t> targets_;
  Eigen::MatrixXd scene_root_;  // S, with S S^T the covariance of the scene
  FittedFrame then_;
  double u_readout_s_;
};

}  // namespace moiregauge::internal
