// SPDX-License-Identifier: Apache-2.0
// Samples from frames and a solved scene: one pose fit per frame, then displacement, budget and status of each target.
#pragma once

#include <optional>
#include <vector>

#include "moiregauge/calibration/scene/out_of_plane.h"
#include "moiregauge/displacement/precise/joint_in_scene.h"
#include "moiregauge/displacement/precise/precise_budget.h"
#include "moiregauge/displacement/precise/precise_scene.h"

namespace moiregauge::internal {

// Fits of compressed frames without the codec's error. Not ok for other footage.
struct FitsByNoise {
  FrameFit now, then;
};

class FramesInScene {
 public:
  // A frame's fit with the budgets of its targets. No budget: the fit or that of the reference frame is not ok.
  struct SolvedFrame {
    FrameFit now;
    FitsByNoise by_noise;
    std::optional<FrameBudget> budget;
    std::vector<std::optional<ShownHeight>> heights;  // per site marker
    // By the movements beyond displacement, per site marker, mm. Empty: there are none.
    std::vector<Extent<frame::Board>> u_by_movement;
  };

  // `reference` and `scene` must outlive this object. `by_noise`: for compressed footage, its frames without the codec's
  // error.
  FramesInScene(const Reference& reference, const PreciseScene& scene, std::optional<FrameSeries> by_noise);

  // Adds the samples of all observations to `solution`. `place`: index of each observation among the scene's frames;
  // 0: it is not among them.
  void measure(const Observations& observations, const std::vector<std::size_t>& place, Solution& solution) const;

  // Returns the joint errors of these samples: the frames are fitted again, with the rotations of the targets.
  [[nodiscard]] JointErrors joint_errors(const Observations& observations, const std::vector<std::size_t>& place) const;

  // Returns the samples of one frame, targets in the site's order. The frame need not be among the scene's frames.
  // `read`: the frame with pose and shifts to start from; empty: too few references were read.
  // `is_far`: targets whose fringe order continuity does not give, one per site marker.
  [[nodiscard]] Samples measure_one(const Observation& seen, const std::optional<BundleFrame>& read,
                                    const std::vector<bool>& is_far) const;

 private:
  [[nodiscard]] BundleFrame weighed(const BundleFrame& frame) const;
  [[nodiscard]] BundleFrame placed(const BundleFrame& seen) const;
  [[nodiscard]] FrameFit fit_with_own_errors(BundleFrame& frame, FrameDetail detail) const;
  [[nodiscard]] FrameFit fit_by_noise(std::size_t place, const BundleFrame& from) const;
  [[nodiscard]] FrameRotations rotations_in(std::size_t place, BundleFrame frame, const FrameFit& fit) const;
  [[nodiscard]] FittedFrame reference_fit() const;
  [[nodiscard]] FittedFrame fit_of(std::size_t place) const;
  [[nodiscard]] std::vector<Extent<frame::Board>> u_motion(std::size_t place) const;
  [[nodiscard]] std::vector<Extent<frame::Board>> u_by_movement(const BundleFrame& placed) const;
  [[nodiscard]] Sample sample_of(const Observation& seen, std::size_t marker, const SolvedFrame& frame,
                                 bool is_far) const;
  [[nodiscard]] Sample judged(Sample sample) const;
  // Returns the target's movement out of the plane since the reference frame, if both frames show its size.
  [[nodiscard]] std::optional<OutOfPlane> movement_out_of_plane(std::size_t marker, const SolvedFrame& frame) const;

  const Reference& reference_;
  const Site& site_;
  const PreciseScene& solved_;
  const Scene& scene_;
  std::optional<FrameSeries> by_noise_;
  PreciseBudget budget_;
  std::vector<std::optional<ShownHeight>> heights_then_;  // in the reference frame, per site marker
};

}  // namespace moiregauge::internal
