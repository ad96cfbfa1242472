// SPDX-License-Identifier: Apache-2.0
// The bundle's normal equations. Frames know of each other only through the scene, so every frame's shifts and pose are
// eliminated where they stand: what is left has the size of the scene, whatever the number of frames.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "moiregauge/calibration/scene/bundle.h"
#include "moiregauge/calibration/scene/patch_residual.h"

namespace moiregauge::internal {

// All unknowns at one place.
struct BundleState {
  CommonNumbers common{};
  std::vector<MarkerShape> markers;
  std::vector<Pose> poses;                                // one per frame
  std::vector<std::vector<Extent<frame::Board>>> shifts;  // by frame, then site marker
  std::vector<Motion> motions;                            // one per frame, of a rolling shutter
};

// One patch of the footage.
struct BundlePatch {
  std::size_t frame;
  std::size_t marker;
  bool shifts;  // a target that may have moved
  PatchResidual residual;
  // Of a rolling shutter: the residual per motion otherwise than expected, and the motion's prior.
  struct Rows {
    Eigen::Matrix<double, PatchResidual::kSize, kMotionParameters> by_motion;
    Eigen::Matrix<double, kMotionParameters, kMotionParameters> information;
  };
  std::shared_ptr<const Rows> rows{};
  [[nodiscard]] double chi2(const BundleState& at) const;
};

// Prior of the scene's parameters: those that all markers share, then five per marker.
struct SceneParameter {
  int index;  // of all parameters; only those to be solved are listed
  double mean, u;
};

// chi2 of a patch of 18 is 18 +- 6; one whose root is beyond this counts by its distance, not its square.
inline constexpr double kRobustFrom = 10.0;
[[nodiscard]] double robust(double chi2);

[[nodiscard]] double& parameter(BundleState& state, int index);

// Patches in the order of their frames.
class BundleNormal {
 public:
  BundleNormal(std::span<const BundlePatch> patches, std::span<const SceneParameter> free, const BundleState& at);

  struct Step {
    BundleState to;
    double gain = 0.0;  // of chi2 and priors together, to second order
  };
  // `damping`: added to every diagonal entry, as a part of it (Marquardt 1963). Nothing when it is too small for the
  // system to be solved.
  [[nodiscard]] std::optional<Step> step(double damping) const;
  // The scene held fixed, undamped: every frame's own step to where it fits best.
  [[nodiscard]] std::optional<BundleState> step_of_frames() const;

 private:
  // Columns of the design, and behind them those of the motion.
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
  [[nodiscard]] Eigen::Index size() const;  // of the scene's parameters and the right side
  [[nodiscard]] std::size_t end_of_frame(std::size_t first) const;

  std::span<const BundlePatch> patches_;
  std::span<const SceneParameter> free_;
  BundleState at_;
  std::vector<PatchNormal<0>> normal_;  // one per patch, weighted
  // Of patches with rows: the motion's columns against all others and against themselves.
  std::vector<Eigen::Matrix<double, kMotionParameters, PatchColumn::kColumns + kMotionParameters>> of_motion_;
};

}  // namespace moiregauge::internal
