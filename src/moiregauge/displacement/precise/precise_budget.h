// SPDX-License-Identifier: Apache-2.0
// What the displacement of a target owes to what, by `precise`.
#pragma once

#include "moiregauge/calibration/scene/frame_fit.h"
#include "moiregauge/displacement/sample.h"

namespace moiregauge::internal {

class PreciseBudget {
 public:
  // scene   covariance of all of its parameters
  // then    the reference frame's fit
  // u_readout_s   of a rolling shutter's readout
  PreciseBudget(const Site& site, Eigen::MatrixXd scene, FrameFit then, double u_readout_s = 0.0);

  // Of `now` less `then`, for a displacement of `moved` mm.
  [[nodiscard]] Budget budget(const FrameFit& now, std::size_t marker, Extent<frame::Board> moved) const;
  // The same of compressed footage: `now` and `then` hold the codec's error, these fits of the same frames do not. What
  // they differ by is the codec's part.
  [[nodiscard]] Budget budget(const FrameFit& now, const FrameFit& now_by_noise, const FrameFit& then_by_noise,
                              std::size_t marker, Extent<frame::Board> moved) const;
  [[nodiscard]] const FrameFit& then() const { return then_; }

 private:
  struct Share;
  [[nodiscard]] Share share(const Eigen::RowVectorXd& k, std::size_t marker, double across_mm) const;

  Eigen::MatrixXd scene_;
  FrameFit then_;
  double u_readout_s_;
  double u_axis_rad_ = 0.0;  // of the direction of the board's axes
};

// All parts together.
[[nodiscard]] Extent<frame::Board> total(const Budget& budget);

}  // namespace moiregauge::internal
