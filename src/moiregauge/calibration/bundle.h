// SPDX-License-Identifier: Apache-2.0
// Self-calibration: one least squares over camera, markers and the poses of many frames.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "moiregauge/calibration/scene.h"
#include "moiregauge/phase/patch_fit.h"
#include "moiregauge/site/site.h"

namespace moiregauge {

// One frame as the bundle takes it.
struct BundleFrame {
  long frame = 0;
  Pose pose;                                    // where to start
  std::vector<std::optional<PatchFit>> points;  // one per site marker
  std::vector<Extent<frame::Board>> shift;      // of the targets, where to start; one per site marker, mm
  bool at_rest = false;                         // targets known not to have moved: shift is zero
};

// What is known beforehand: values (a Scene's) and their standard uncertainties in the Scene's order.
struct ScenePrior {
  Camera camera;
  std::array<double, kCameraParameters> u_camera{};
  std::vector<MarkerShape> markers;
  std::vector<MarkerShape> u_markers;  // 0: held fixed
};

// Nothing known of the lens but the picture's size; of the markers what the site says. A calibrated camera narrows it.
[[nodiscard]] ScenePrior scene_prior(const Site& site, int width, int height, const std::optional<Camera>& camera);

struct BundleSolution {
  Scene scene;
  std::vector<BundleFrame> frames;  // poses and shifts as solved
};

enum class FocalLength { kAsModel, kHeld };
// When to stop: where nothing moves any more, or where chi2 is known to a thousandth, which takes a few steps even in a
// valley without end.
enum class Until { kStands, kChi2Stands };

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
                                     FocalLength f = FocalLength::kAsModel, Until until = Until::kStands) const;
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
                                          const Scene* start = nullptr, Until until = Until::kStands);

}  // namespace moiregauge
