// SPDX-License-Identifier: Apache-2.0
// Normal equations of the bundle adjustment. Frames are connected through the scene only, so shifts and pose are
// eliminated frame by frame. The remaining system has the size of the scene, whatever the number of frames.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "moiregauge/calibration/scene/bundle.h"
#include "moiregauge/calibration/scene/patch_residual.h"

namespace moiregauge::internal {

// Values of all unknowns.
struct BundleState {
  CommonNumbers common{};
  std::vector<MarkerShape> markers;
  std::vector<Pose> poses;                                // one per frame
  std::vector<std::vector<Extent<frame::Board>>> shifts;  // by frame, then site marker
  std::vector<Motion> motions;                            // one per frame, for a rolling shutter
};

// One grating in one frame.
struct BundlePatch {
  std::size_t frame;
  std::size_t marker;
  bool shifts;  // true for a target that may have moved
  PatchResidual residual;
  // Rolling shutter: derivative of the whitened residual by the motion beyond the expected one, and the prior of that
  // motion.
  struct Rows {
    Eigen::Matrix<double, PatchResidual::kSize, kMotionParameters> by_motion;
    Eigen::Matrix<double, kMotionParameters, kMotionParameters> information;
  };
  std::shared_ptr<const Rows> rows{};
  // `pose`: that of its frame in `at`.
  [[nodiscard]] double chi2(const BundleState& at, const TurnedPose& pose) const;
};

// Free parameter of the scene with its prior. Order: the parameters that all markers share, then five per marker.
struct SceneParameter {
  int index;  // among all parameters of the scene
  double mean, u;
};

// Huber's limit on sqrt(chi2) of a grating. Noise alone gives chi2 = 18 +- 6. Beyond the limit a grating counts by its
// distance instead of its square. Chosen.
inline constexpr double kRobustFrom = 10.0;
[[nodiscard]] double robust(double chi2);
// Returns the weight of a grating: the slope of that loss.
[[nodiscard]] double robust_weight(double chi2);

// Least information of a shift axis, 1/mm^2. It keeps an axis that the grating does not show in place.
inline constexpr double kLeastShiftInformation = 1.0 / (kUnknownShift * kUnknownShift);

[[nodiscard]] double& parameter(BundleState& state, int index);

// Linearises all patches at `at`. The patches must be in the order of their frames.
class BundleNormal {
 public:
  BundleNormal(std::span<const BundlePatch> patches, std::span<const SceneParameter> free, const BundleState& at);

  struct Step {
    BundleState to;
    double gain = 0.0;  // predicted fall of chi2 and priors, to second order
  };
  // Returns the damped Gauss-Newton step. `damping` is relative to the diagonal (Marquardt 1963).
  // Fails (nothing): the damped system is not positive definite.
  [[nodiscard]] std::optional<Step> step(double damping) const;

 private:
  // Columns of the design matrix, then those of the motion.
  template <int kMotion>
  using PatchNormal = Eigen::Matrix<double, PatchColumn::kColumns + kMotion, PatchColumn::kColumns + kMotion>;
  template <int kMotion>
  struct Frame;
  struct Eliminated;
  template <int kMotion>
  [[nodiscard]] PatchNormal<kMotion> normal_of(std::size_t patch) const;
  template <int kMotion>
  [[nodiscard]] Frame<kMotion> eliminated(std::size_t first, std::size_t end, double damping,
                                          Eigen::MatrixXd& scene) const;
  template <int kMotion>
  [[nodiscard]] double substituted(std::size_t first, std::size_t end, const Frame<kMotion>& frame,
                                   const Eigen::VectorXd& moved, BundleState& to) const;
  [[nodiscard]] Eliminated frame_eliminated(std::size_t first, double damping, Eigen::MatrixXd& scene) const;
  [[nodiscard]] double frame_substituted(std::size_t first, const Eliminated& frame, const Eigen::VectorXd& moved,
                                         BundleState& to) const;
  [[nodiscard]] Eigen::Index size() const;  // number of free parameters, plus one for the right-hand side
  [[nodiscard]] int place_of(std::size_t marker, int k) const;
  [[nodiscard]] std::size_t end_of_frame(std::size_t first) const;

  std::span<const BundlePatch> patches_;
  std::span<const SceneParameter> free_;
  std::vector<int> places_;  // among the free parameters, for each scene parameter; -1: fixed
  BundleState at_;
  std::vector<PatchNormal<0>> normal_;  // one per patch, weighted
  // For patches with a rolling shutter: products of the motion's columns with all others and with themselves.
  std::vector<Eigen::Matrix<double, kMotionParameters, PatchColumn::kColumns + kMotionParameters>> of_motion_;
};

}  // namespace moiregauge::internal
