// SPDX-License-Identifier: Apache-2.0
// Where a camera of known f, cx and cy is, and how it sees the board from there.
#pragma once

#include <array>
#include <optional>
#include <span>

#include "moiregauge/geometry/camera.h"
#include "moiregauge/geometry/view.h"

namespace moiregauge::internal {

// Where the camera is: X_cam = R(turn) (X, -Y, -Z) + shift for a board point (X, Y, Z) in mm; camera x right, y down, z
// forward.
struct Pose {
  std::array<double, 3> turn{};   // axis times angle, rad
  std::array<double, 3> shift{};  // mm
};

[[nodiscard]] IdealFromBoard view_of(const Pose& pose, const Camera& camera);

// The pose from which a camera with this f, cx, cy sees the board as `view` says: exact when the view is a picture of a
// plane by that camera, else the nearest rotation.
[[nodiscard]] Pose pose_of(const IdealFromBoard& view, const Camera& camera);

// How a known camera sees the board when it sees three of its points: of the up to four poses from which three points
// look alike, the one that Gauss-Newton reaches from `near`, the view of the frame before. Nothing when it reaches
// none: the points lie on a line, or the camera has jumped.
[[nodiscard]] std::optional<IdealFromBoard> view_of_three(std::span<const BoardPoint> board,
                                                          std::span<const IdealPoint> ideal, const Camera& camera,
                                                          const IdealFromBoard& near);

}  // namespace moiregauge::internal
