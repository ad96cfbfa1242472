// SPDX-License-Identifier: Apache-2.0
// Movement of a target towards the camera, in one frame of a solved scene. A fit with fixed heights shows it as a
// displacement wherever the line of sight is oblique.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "moiregauge/calibration/scene/frame_fit.h"

namespace moiregauge::internal {

// Height of a target in one frame, by the size of its grating.
struct ShownHeight {
  double height_mm = 0.0;  // above the height of the scene
  double stretch = 0.0;    // relative: longer along the print's x than along its y. A rolling shutter does that.
  double u_height_mm = 0.0, u_stretch = 0.0;  // by the stated noise
  Pose camera;
  Eigen::Vector3d rotation_rad = Eigen::Vector3d::Zero();  // the target's own, if it rotates
  Extent<frame::Board> per_mm;                             // apparent displacement per mm of height
};

// Fits height, stretch and rotation of every target, with its shift and the pose of `fit`.
// The stretch of a target that rotates is not fitted, because a tilt stretches it, too.
// `frame`, `fit`: a frame and its fit in this scene. The points should have the u of noise alone.
// Fails (nothing): the target was not read, or its grating does not show its size along both axes.
// Error: u is without that of the pose. The pose is fitted as if the target were unmoved. That hides a part of
// the height, most of it if the references are near to each other.
[[nodiscard]] std::vector<std::optional<ShownHeight>> shown_heights(const Site& site, const Scene& scene,
                                                                    const BundleFrame& frame, const FrameFit& fit);

// Returns the standard uncertainty of a grating's size between two views beyond noise, relative. `turned_rad`: the
// target's rotation between them.
[[nodiscard]] double u_of_size(const Pose& now, const Pose& then, const Eigen::Vector3d& turned_rad);

// Movement out of the plane between two frames.
struct OutOfPlane {
  double height_mm = 0.0, u_mm = 0.0;
  double in_u = 0.0;  // what both axes of the grating show of it, in u
  // Displacement as which both heights appear, mm. One that differs from the scene's appears by a change of view alone.
  Extent<frame::Board> apparent;
};

[[nodiscard]] OutOfPlane out_of_plane(const ShownHeight& now, const ShownHeight& then);

// Heights of a target over many frames, as each axis of its grating shows them. They are independent of the noise of the
// reference frame, and small movements in many frames add up.
class HeightSeries {
 public:
  // Adds the next frame in order of time.
  void add(const ShownHeight& shown);
  // Return true if both axes of the grating prove a movement out of the plane. The heights scatter by more than the
  // stated noise, or drift by more than they change from frame to frame. Behind a codec the stated noise is too large.
  [[nodiscard]] bool scatters() const;
  [[nodiscard]] bool drifts() const;

 private:
  struct Axis {
    double weight = 0.0, first = 0.0, second = 0.0;  // sums of 1, h and h^2, weighted
    double sum = 0.0, squares = 0.0;                 // sums of h and h^2
    double last = 0.0, steps = 0.0;                  // last h, and the sum of the squared steps between frames
    [[nodiscard]] bool scatters(double frames) const;
    [[nodiscard]] bool drifts(double frames, double u_mm) const;
  };
  static constexpr long kMinFrames = 10;  // chosen
  std::array<Axis, 2> axes_;
  std::optional<ShownHeight> first_;
  double u_view_mm_ = 0.0;  // largest u by the change of view
  long frames_ = 0;
};

}  // namespace moiregauge::internal
