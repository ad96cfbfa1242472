// SPDX-License-Identifier: Apache-2.0
// Uncertainty budget of `precise`: the causes of u of a target's displacement.
#pragma once

#include <array>
#include <vector>

#include "moiregauge/calibration/scene/frame_fit.h"
#include "moiregauge/displacement/camera_pose.h"
#include "moiregauge/displacement/sample.h"

namespace moiregauge::internal {

// Budgets of the targets of one frame. A target's sensitivity to the scene is its own part plus the pose's part, which all
// targets share. So the products with the scene's covariance are computed once per frame.
class FrameBudget;

class PreciseBudget {
 public:
  // `scene`: covariance of all scene parameters.
  // `then`: fit of the reference frame, which must be ok.
  // `u_readout_s`: of a rolling shutter's readout time.
  PreciseBudget(const Site& site, const Eigen::MatrixXd& scene, FrameFit then, double u_readout_s = 0.0);

  // Returns the budgets of `now` minus the reference frame. `now` must be ok. Both must outlive the result.
  [[nodiscard]] FrameBudget of_frame(const FrameFit& now) const;
  // Returns the camera pose of a frame. Its uncertainty includes the noise of the frame and that of the scene.
  [[nodiscard]] CameraPose pose(const FrameFit& now) const;
  [[nodiscard]] const FrameFit& then() const { return then_; }
  // Returns the standard uncertainty of the board's normal, rad: by how much of a movement along it appears along x and y.
  // The references' heights define it.
  [[nodiscard]] Extent<frame::Board> u_normal() const { return u_normal_; }

 private:
  friend class FrameBudget;
  enum Group { kLens, kScale, kPlace, kGroups };
  // Products of a pose's sensitivity with the covariance, by group of parameters: u x poses.
  struct Products {
    Eigen::MatrixXd pose;  // poses x u
    std::array<Eigen::MatrixXd, kGroups> by_group;
  };
  [[nodiscard]] Products products_of(const FrameFit& fit) const;
  // Returns the change of the pose (and motion) per unit of each uncertain parameter.
  [[nodiscard]] Eigen::MatrixXd pose_by_scene(const FrameFit& fit) const;

  // Only the scene's uncertain parameters (u of them) are kept.
  std::vector<int> place_of_;  // among them, for each scene parameter; -1: certain
  std::vector<Group> group_;   // one per uncertain parameter
  Eigen::MatrixXd scene_;      // their covariance
  FrameFit then_;
  Products products_then_;
  double u_readout_s_;
  double u_axis_rad_ = 0.0;  // direction of the board's axes, rad
  Extent<frame::Board> u_normal_;
};

class FrameBudget {
 public:
  // Returns the budget of a target, for a displacement of `moved` mm.
  [[nodiscard]] Budget budget(std::size_t marker, Extent<frame::Board> moved) const;
  // Returns the same for compressed footage. The frame and the reference frame include the codec's error, the fits by
  // noise do not. The difference of both is the codec's part.
  [[nodiscard]] Budget budget(const FrameFit& now_by_noise, const FrameFit& then_by_noise, std::size_t marker,
                              Extent<frame::Board> moved) const;

 private:
  friend class PreciseBudget;
  // Variances, mm^2.
  struct Share {
    double lens = 0.0, geometry = 0.0, scale = 0.0, axis = 0.0, rest = 0.0;
  };
  struct Sensitivity;
  FrameBudget(const PreciseBudget& all, const FrameFit& now);
  [[nodiscard]] Sensitivity sensitivity(std::size_t marker, int axis) const;
  [[nodiscard]] double variance(const Sensitivity& k, const std::vector<int>& own, const Eigen::MatrixXd& to_scene,
                                const Eigen::MatrixXd& own_poses) const;
  [[nodiscard]] std::vector<int> own_position_of(std::size_t marker) const;
  [[nodiscard]] double derivative(const Sensitivity& k, int place) const;
  [[nodiscard]] double product_with_places(const Sensitivity& k, int place) const;
  [[nodiscard]] Share share(std::size_t marker, int axis, double across_mm) const;

  const PreciseBudget& all_;
  const FrameFit& now_;
  // Sensitivity of the pose of this frame, and its change since the reference frame: twice the poses x u.
  Eigen::MatrixXd poses_;
  // Products with the covariance, by group and for all together, and their products with `poses_`.
  std::array<Eigen::MatrixXd, PreciseBudget::kGroups> by_group_, of_group_;
  Eigen::MatrixXd whole_, of_whole_;
};

// Returns the factor by which the frame's variance exceeds the stated noise, at least 1.
[[nodiscard]] double inflation(const FrameFit& fit);

// Returns the root of the sum of squares of all parts, mm.
[[nodiscard]] Extent<frame::Board> total(const Budget& budget);

}  // namespace moiregauge::internal
