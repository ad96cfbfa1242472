// SPDX-License-Identifier: Apache-2.0
// Targets that rotate with the structure or leave their plane. A frame's fit solves the displacement of a target and not
// these movements. They would therefore bend the camera's pose and count as print error of all gratings.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "moiregauge/calibration/scene/frame_fit.h"
#include "moiregauge/calibration/scene/frame_series.h"
#include "moiregauge/calibration/scene/scene.h"
#include "moiregauge/site/site.h"

namespace moiregauge::internal {

// Movement of a target beyond its displacement: height (mm), then rotation (rad) through the centre of its grating. The
// axes are the board's x, y and z: right, up, towards the camera.
using Movement4 = Eigen::Vector4d;
struct MovementAxis {
  static constexpr Eigen::Index kHeight = 0, kRotation = 1, kInPlane = 3;
};

// Movement of one target over a run. Zero: it is only displaced.
struct TargetMovement {
  Movement4 prior = Movement4::Zero();  // standard uncertainty about zero of the movement in any frame
  Movement4 u = Movement4::Zero();      // standard uncertainty by noise of one frame's movement
  [[nodiscard]] bool leaves_plane() const { return prior(MovementAxis::kHeight) > 0.0; }
  [[nodiscard]] bool rotates() const { return prior.tail<3>().maxCoeff() > 0.0; }
  [[nodiscard]] bool moves() const { return prior.maxCoeff() > 0.0; }
};
using TargetMovements = std::vector<TargetMovement>;  // one per site marker

// Returns which targets rotate or leave their plane, with three times the rms of it. Each target is fitted with
// displacement, height and rotation, and the pose stays that of the frame. It moves if the mean square about any axis,
// without the largest, exceeds kProvenMovement times that of noise, and of the median reference. For the height, both
// axes of the grating must also show it (HeightSeries). A height that drifts needs only twice the mean square of the
// median reference. Empty: all are only displaced.
// `frames`: with the covariance of noise alone, and their poses in this scene.
[[nodiscard]] TargetMovements find_movements(const Site& site, const Scene& scene, std::span<const BundleFrame> frames);
inline constexpr double kProvenMovement = 9.0;

// Point of a grating whose displacement is measured, in the coordinates of its template.
struct RotationCentre {
  PrintPoint at{};         // pitches
  double u_mm = 0.0;       // standard uncertainty of its position on the print
  bool is_middle = false;  // the symmetry point in the middle of the print; otherwise where the site has the grating
};

// Removes the movements of targets beyond their displacement from frames.
class MovementRemoval {
 public:
  // `centres`: one per site marker.
  MovementRemoval(Site site, Scene scene, TargetMovements movements, std::vector<RotationCentre> centres)
      : site_(std::move(site)),
        scene_(std::move(scene)),
        movements_(std::move(movements)),
        centres_(std::move(centres)) {}

  // Returns the frame with its points where they would be if the targets were only displaced (at most three Gauss-Newton
  // steps). The points' covariance then includes the prior's movements, so a fit does not depend on them to first order.
  // `read`: a frame as read. It is returned as it is if its gratings determine no pose.
  [[nodiscard]] BundleFrame displaced_only(const BundleFrame& read) const;
  [[nodiscard]] const TargetMovement& movement(std::size_t marker) const { return movements_[marker]; }
  [[nodiscard]] const RotationCentre& centre(std::size_t marker) const { return centres_[marker]; }
  // Returns the uncertainty of a target's displacement beyond noise, mm. It has two parts: the centre of the rotation, and
  // the size of the grating between two views, which shows the height.
  [[nodiscard]] Extent<frame::Board> u_beyond_noise(std::size_t marker, const BundleFrame& now,
                                                    const BundleFrame& then) const;

 private:
  // Removes what `fit` still shows of one target's movement. Returns the largest rotation of it, rad, or its height
  // relative to the distance.
  double remove(std::size_t marker, const BundleFrame& read, const FrameFit& fit, BundleFrame& frame) const;

  Site site_;
  Scene scene_;
  TargetMovements movements_;
  std::vector<RotationCentre> centres_;
};

// Returns the frames without the movements beyond displacement, or as they are if `removal` is null.
[[nodiscard]] FrameSeries only_displaced(const FrameSeries& frames, std::shared_ptr<const MovementRemoval> removal);

}  // namespace moiregauge::internal
