// SPDX-License-Identifier: Apache-2.0
// Self-calibration: one least squares over camera, markers and the poses of many frames.
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

// A rolling shutter: how the nine points of every patch are off, in pitches (x of all nine, then y), per rate and
// acceleration by which the camera moves otherwise than expected while rows are read (set_back in row_motion.h), and,
// in the last column, per second of readout.
inline constexpr int kMotionParameters = 12;
struct RowDesign {
  using Columns = Eigen::Matrix<double, 2 * kPatchPoints, kMotionParameters + 1>;
  std::vector<Columns> by_marker;                                           // one per site marker
  Eigen::Matrix<double, kMotionParameters, kMotionParameters> information;  // prior about zero
};
using Motion = Eigen::Matrix<double, kMotionParameters, 1>;

inline constexpr double kNotTimed = std::numeric_limits<double>::quiet_NaN();

// One frame as the bundle takes it.
struct BundleFrame {
  long frame = 0;
  Pose pose;                                    // where to start
  std::vector<std::optional<PatchFit>> points;  // one per site marker
  std::vector<Extent<frame::Board>> shift;      // of the targets, where to start; one per site marker, mm
  bool at_rest = false;                         // targets known not to have moved: shift is zero
  double time_s = kNotTimed;
  std::optional<RowDesign> rows = std::nullopt;  // of a rolling shutter, points set back
  Motion motion = Motion::Zero();                // otherwise than expected, where to start
};

// In which direction of the picture as displayed the sensor's rows follow one another.
enum class ReadoutDirection { kDown, kUp, kRight, kLeft };

// What is known beforehand: values (a Scene's) and their standard uncertainties in the Scene's order.
struct ScenePrior {
  Camera camera;
  std::array<double, kCameraParameters> u_camera{};
  double stretch = 0.0, u_stretch = 0.0;
  std::vector<MarkerShape> markers;
  std::vector<MarkerShape> u_markers;  // 0: held fixed
  ReadoutDirection rows_run = ReadoutDirection::kDown;
};

// Of what all markers share, in the scene's order.
[[nodiscard]] std::array<double, kCommonParameters> uncertainties_of(const ScenePrior& prior);

// Nothing known of the lens but the picture's size; of the markers what the site says. A calibrated camera narrows it.
[[nodiscard]] ScenePrior scene_prior(const Site& site, int width, int height, const std::optional<Camera>& camera);

// The same with a camera of which nothing is known but where it is to be looked for: about the given one.
[[nodiscard]] ScenePrior with_unknown_lens(ScenePrior prior);

struct BundleSolution {
  Scene scene;
  std::vector<BundleFrame> frames;  // poses and shifts as solved
};

enum class FocalLength { kAsModel, kHeld };
// When to stop: where nothing moves any more, or where chi2 is known to a thousandth, which takes a few steps even in a
// valley without end.
enum class Until { kConverged, kChi2Converged };

// Frames with all that does not change from one solution to the next made ready once.
class Bundle {
 public:
  Bundle(const Site& site, std::span<const BundleFrame> frames, const ScenePrior& prior);
  ~Bundle();
  Bundle(const Bundle&) = delete;
  Bundle& operator=(const Bundle&) = delete;

  // Minimises chi2 of all patches plus that of the priors (Levenberg and Marquardt; robust against a patch that fits
  // nothing). What the model leaves out stays at its value in `scene`. Begins with these frames' poses and shifts.
  [[nodiscard]] BundleSolution solve(const SceneModel& model, const Scene& scene, std::span<const BundleFrame> frames,
                                     FocalLength f = FocalLength::kAsModel, Until until = Until::kConverged) const;
  // Begins with the prior and the frames as they came.
  [[nodiscard]] BundleSolution solve(const SceneModel& model) const;
  // By how much the model's first step should lower chi2 and priors together, to second order; infinite if that cannot
  // be told.
  [[nodiscard]] double predicted_reduction(const SceneModel& model, const BundleSolution& from) const;

  struct Footage;

 private:
  std::unique_ptr<const Footage> footage_;
};

[[nodiscard]] BundleSolution solve_bundle(const Site& site, std::span<const BundleFrame> frames,
                                          const ScenePrior& prior, const SceneModel& model,
                                          const Scene* start = nullptr, Until until = Until::kConverged);

}  // namespace moiregauge::internal
