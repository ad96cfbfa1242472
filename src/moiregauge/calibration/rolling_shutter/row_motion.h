// SPDX-License-Identifier: Apache-2.0
// A rolling shutter: the rows of a frame are read one after the other, and the camera moves meanwhile. Every point is
// seen at a time of its own, t = t of the frame + its row's delay, by a camera whose pose is a short series in that
// delay.
#pragma once

#include <array>
#include <vector>

#include <Eigen/Core>

#include "moiregauge/calibration/rolling_shutter/smooth_path.h"
#include "moiregauge/calibration/scene/bundle.h"
#include "moiregauge/calibration/scene/frame_fit.h"

namespace moiregauge::internal {

// Of a picture that is shown turned clockwise by quarter turns: 90 deg makes rows columns, the first one at the right.
[[nodiscard]] ReadoutDirection rows_run(int rotation_deg);

// Rows at -1/2 .. 1/2 of the readout, 0 in the picture's middle, which is where a frame's time is.
[[nodiscard]] double share_of_row(ImagePoint p, const Camera& picture, ReadoutDirection run);

// A pose in coordinates whose noise and motion are independent of one another: turn away from the run's reference pose
// about the camera's axes (rad), direction to the board's origin (x / z, y / z) and log of its distance.
inline constexpr int kPathParameters = 6;
using PathPlace = Eigen::Matrix<double, kPathParameters, 1>;
[[nodiscard]] PathPlace path_place(const Pose& pose, const Pose& reference);
[[nodiscard]] Pose pose_at(const PathPlace& place, const Pose& reference);
// Variances of a place from the pose's covariance (6 x 6).
[[nodiscard]] PathPlace path_variance(const Pose& pose, const Eigen::MatrixXd& covariance);

// Of one target, mm per second, and per second squared.
struct TargetMotion {
  Extent<frame::Board> rate, acceleration;
};

// One frame's motion: expected from its neighbours, and how far it may be from that.
struct FrameMotion {
  std::array<PathPoint, kPathParameters> camera{};
  std::vector<TargetMotion> targets{};  // one per site marker; empty: none moves
};

// The frame as a global shutter would have seen it at its middle row's time, if camera and targets moved as expected: points
// set back, and how they change with what the motion may be more (RowDesign). To be made anew when scene, pose or
// motion have changed by much.
// seen      the frame as it was read, with pose and shifts as known
[[nodiscard]] BundleFrame to_frame_time(const Site& site, const Scene& scene, const BundleFrame& seen,
                                        const FrameMotion& motion, const Pose& reference, double readout_s,
                                        ReadoutDirection run);

// Returns how much the frame's chi-squared falls if the camera may rotate, at a changing rate, while its rows are read
// (kTurning parameters with a wide prior). A large value suggests a rolling shutter.
inline constexpr int kTurning = 6;
[[nodiscard]] double chi2_of_turning(const Site& site, const Scene& scene, const BundleFrame& frame,
                                     const FrameFit& fit, ReadoutDirection run);

}  // namespace moiregauge::internal
