// SPDX-License-Identifier: Apache-2.0
// Targets that rotate with the structure. A frame's fit solves the displacement of a target and not its rotation. The
// rotation would therefore bend the camera's pose and count as print error of all gratings.
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

// Rotation about the board's x, y and z axes (right, up, towards the camera) through the centre of a grating, rad.
using Rotation3 = Eigen::Vector3d;

// Rotation of one target over a run. Zero: it does not rotate.
struct TargetRotation {
  Rotation3 prior_rad = Rotation3::Zero();  // standard uncertainty about zero of the rotation in any frame
  double u_in_plane_rad = 0.0;              // standard uncertainty by noise of one frame's rotation about z
  [[nodiscard]] bool rotates() const { return prior_rad.maxCoeff() > 0.0; }
};
using TargetRotations = std::vector<TargetRotation>;  // one per site marker

// Returns which targets rotate from frame to frame, with three times their rms rotation. Each target is fitted with
// displacement and rotation, and the pose stays that of the frame. It rotates if the mean square about any axis,
// without the largest, exceeds kRotates times that of noise, and of the median reference. Empty: none rotates.
// `frames`: with the covariance of noise alone, and their poses in this scene.
[[nodiscard]] TargetRotations find_rotations(const Site& site, const Scene& scene, std::span<const BundleFrame> frames);
inline constexpr double kRotates = 9.0;

// Point of a grating whose displacement is measured, in the coordinates of its template.
struct RotationCentre {
  PrintPoint at{};         // pitches
  double u_mm = 0.0;       // standard uncertainty of its position on the print
  bool is_middle = false;  // the symmetry point in the middle of the print; otherwise where the site has the grating
};

// Removes the rotations of targets from frames.
class RotationRemoval {
 public:
  // `centres`: one per site marker.
  RotationRemoval(Site site, Scene scene, TargetRotations rotations, std::vector<RotationCentre> centres)
      : site_(std::move(site)),
        scene_(std::move(scene)),
        rotations_(std::move(rotations)),
        centres_(std::move(centres)) {}

  // Returns the frame with its points where they would be without the rotations (at most three Gauss-Newton steps).
  // The points' covariance then includes the prior's rotations, so a fit does not depend on them to first order.
  // `read`: a frame as read. It is returned as it is if its gratings determine no pose.
  [[nodiscard]] BundleFrame unrotated(const BundleFrame& read) const;
  [[nodiscard]] const TargetRotation& rotation(std::size_t marker) const { return rotations_[marker]; }
  [[nodiscard]] const RotationCentre& centre(std::size_t marker) const { return centres_[marker]; }
  // Returns the uncertainty of a target's displacement by that of the centre of its rotation, mm.
  [[nodiscard]] double u_by_centre(std::size_t marker, const BundleFrame& now, const BundleFrame& then) const;

 private:
  // Removes what `fit` still shows of one target's rotation. Returns the largest component of it, rad.
  double remove(std::size_t marker, const BundleFrame& read, const FrameFit& fit, BundleFrame& frame) const;

  Site site_;
  Scene scene_;
  TargetRotations rotations_;
  std::vector<RotationCentre> centres_;
};

// Returns the frames without the rotations, or as they are if `removal` is null.
[[nodiscard]] FrameSeries without_rotations(const FrameSeries& frames, std::shared_ptr<const RotationRemoval> removal);

}  // namespace moiregauge::internal
