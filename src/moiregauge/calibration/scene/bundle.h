// SPDX-License-Identifier: Apache-2.0
// Bundle adjustment: one least squares solution for lens, markers and the camera poses of many frames.
#pragma once

#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "moiregauge/calibration/scene/scene.h"
#include "moiregauge/phase/fit/patch_fit.h"
#include "moiregauge/site/site.h"

namespace moiregauge::internal {

// Rolling shutter: derivatives of the nine points' residuals (pitches; x of all nine, then y) for every marker.
// Columns: 6 rates, 6 accelerations, readout time.
// Rates (1/s) and accelerations (1/s^2) are the deviation of the camera's motion from the expected one, in the
// coordinates of PathPlace. The readout time is in s. Source: `to_frame_time` in row_motion.h.
inline constexpr int kMotionParameters = 12;
struct RowDesign {
  using Columns = Eigen::Matrix<double, 2 * kPatchPoints, kMotionParameters + 1>;
  std::vector<Columns> by_marker;  // one per site marker
  // Inverse covariance of the prior about zero.
  Eigen::Matrix<double, kMotionParameters, kMotionParameters> information;
};
using Motion = Eigen::Matrix<double, kMotionParameters, 1>;

// Standard uncertainty along an axis of a shift that the grating does not show, mm. Chosen, far beyond any movement.
inline constexpr double kUnknownShift = 1e4;

inline constexpr double kNotTimed = std::numeric_limits<double>::quiet_NaN();  // time of a frame without a time stamp

// Input of the bundle adjustment from one frame.
struct BundleFrame {
  long frame = 0;
  Pose pose;                                    // start value
  std::vector<std::optional<PatchFit>> points;  // one per site marker
  std::vector<Extent<frame::Board>> shift;      // start values for the targets, one per site marker, mm
  bool at_rest = false;                         // the user states that no target moved: all shifts are zero
  double time_s = kNotTimed;
  std::optional<RowDesign> rows = std::nullopt;  // rolling shutter: the points are already at frame time
  Motion motion = Motion::Zero();                // deviation from the expected motion, start value
  // Movements beyond displacement that were removed from the targets' points, one per site marker: height (mm) and
  // rotation (rad). Empty: none. See target_movement.h.
  std::vector<Eigen::Vector4d> removed{};
};

// Direction in the displayed image in which the sensor reads one row after the other.
enum class ReadoutDirection { kDown, kUp, kRight, kLeft };

// Prior of the scene: values and their standard uncertainties, in the Scene's order.
struct ScenePrior {
  Camera camera;
  std::array<double, kCameraParameters> u_camera{};
  double stretch = 0.0, u_stretch = 0.0;
  std::vector<MarkerShape> markers;
  std::vector<MarkerShape> u_markers;  // 0: fixed
  ReadoutDirection rows_run = ReadoutDirection::kDown;
};

// Returns the prior's standard uncertainties of the parameters that all markers share, in the Scene's order.
[[nodiscard]] std::array<double, kCommonParameters> uncertainties_of(const ScenePrior& prior);

// Returns the prior of the scene. Markers: the site's `known_to`. Lens: `camera` if given, otherwise unknown (f = 2 L
// +- 100 %, for an image with the larger side L in px).
[[nodiscard]] ScenePrior scene_prior(const Site& site, int width, int height, const std::optional<Camera>& camera);

// Returns the prior with the u of an unknown lens about the same camera. No u becomes smaller.
[[nodiscard]] ScenePrior with_unknown_lens(ScenePrior prior);

struct BundleSolution {
  Scene scene;
  std::vector<BundleFrame> frames;  // with the solved poses and shifts
};

enum class FocalLength { kAsModel, kHeld };
// Stop criterion: full convergence, or chi2 known to a thousandth. The second takes few steps even along a flat valley.
// kConvergedIfItFits: the first, but the second while residuals contradict the solution (chi2/dof above 2).
enum class Until { kConverged, kConvergedIfItFits, kChi2Converged };

// Prepares once what all solutions from the same frames share.
class Bundle {
 public:
  Bundle(const Site& site, std::span<const BundleFrame> frames, const ScenePrior& prior);
  ~Bundle();
  Bundle(const Bundle&) = delete;
  Bundle& operator=(const Bundle&) = delete;
  Bundle(Bundle&&) = delete;
  Bundle& operator=(Bundle&&) = delete;

  // Minimises chi2 of all gratings plus that of the priors (Levenberg-Marquardt, at most 40 steps). Huber's loss limits
  // a grating that does not fit. Parameters outside the model keep their value in `scene`. Poses and shifts start from
  // `frames`.
  // Fails (scene.solved = false): the cost is not finite, or f is not positive.
  [[nodiscard]] BundleSolution solve(const SceneModel& model, const Scene& scene, std::span<const BundleFrame> frames,
                                     FocalLength f = FocalLength::kAsModel, Until until = Until::kConverged) const;
  // Solves the model from the prior and the frames given to the constructor.
  [[nodiscard]] BundleSolution solve(const SceneModel& model) const;
  // Returns the fall of chi2 and priors that the model's first step predicts, to second order. Infinite if the normal
  // equations are singular.
  [[nodiscard]] double predicted_reduction(const SceneModel& model, const BundleSolution& from) const;

  struct Footage;

 private:
  std::unique_ptr<const Footage> footage_;
};

// Solves the model for these frames once, from `start`, or from the prior if it is null.
[[nodiscard]] BundleSolution solve_bundle(const Site& site, std::span<const BundleFrame> frames,
                                          const ScenePrior& prior, const SceneModel& model,
                                          const Scene* start = nullptr);

}  // namespace moiregauge::internal
