// SPDX-License-Identifier: Apache-2.0
// Rolling shutter: the image rows are read one after the other while the camera moves. Every point has its own time t =
// t_frame + delay of its row. The pose at that time is a short series in the delay.
#pragma once

#include <array>
#include <vector>

#include <Eigen/Core>

#include "moiregauge/calibration/rolling_shutter/smooth_path.h"
#include "moiregauge/calibration/scene/bundle.h"
#include "moiregauge/calibration/scene/frame_fit.h"

namespace moiregauge::internal {

// Returns the readout direction for the stream's rotation tag, deg clockwise. With 90 deg rows become columns, the
// first one at the right.
[[nodiscard]] ReadoutDirection rows_run(int rotation_deg);

// Returns a point's time relative to the frame time, as a share of the readout time. It is -1/2 to 1/2, and 0 in the
// middle of the image.
[[nodiscard]] double share_of_row(ImagePoint p, const Camera& picture, ReadoutDirection run);

// Camera pose in coordinates with nearly independent noise and motion: rotation, direction and distance.
// Rotation is from the run's reference pose about the camera's axes (rad). Direction is that of the board's origin (x /
// z, y / z), and distance is ln z.
inline constexpr int kPathParameters = 6;
using PathPlace = Eigen::Matrix<double, kPathParameters, 1>;
[[nodiscard]] PathPlace path_place(const Pose& pose, const Pose& reference);
[[nodiscard]] Pose pose_at(const PathPlace& place, const Pose& reference);
// Returns the variances of these coordinates from the covariance of a pose (6 x 6). Error: a few per cent, because
// rotations of the pose are assumed to be about the camera's axes.
[[nodiscard]] PathPlace path_variance(const Pose& pose, const Eigen::MatrixXd& covariance);

// Motion of one target, mm/s and mm/s^2.
struct TargetMotion {
  Extent<frame::Board> rate, acceleration;
};

// Motion in one frame, predicted from its neighbours, with its covariance.
struct FrameMotion {
  std::array<PathPoint, kPathParameters> camera{};
  std::vector<TargetMotion> targets{};  // one per site marker; empty if none moves
};

// Motion in one frame, in coordinates relative to a reference pose.
struct PathMotion {
  const FrameMotion& motion;
  const Pose& reference;
};

struct Readout {
  double duration_s = 0.0;
  ReadoutDirection direction = ReadoutDirection::kDown;
};

// Returns the frame with its points moved to their positions at frame time, as if camera and targets moved as
// predicted. `rows` holds the derivatives by the deviation from that motion (RowDesign). Repeat it when scene, pose or
// motion have changed.
// `seen`: the frame as read, with its current pose and shifts.
[[nodiscard]] BundleFrame to_frame_time(const Site& site, const Scene& scene, const BundleFrame& seen,
                                        const PathMotion& path, const Readout& readout);

// Returns the fall of the frame's chi2 if the camera may rotate at a changing rate during readout (kTurning parameters
// with a wide prior). A large value suggests a rolling shutter.
inline constexpr int kTurning = 6;
[[nodiscard]] double chi2_of_turning(const Site& site, const Scene& scene, const BundleFrame& frame,
                                     const FrameFit& fit, ReadoutDirection run);

}  // namespace moiregauge::internal
