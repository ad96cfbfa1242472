// SPDX-License-Identifier: Apache-2.0
// Camera pose from views of the board, for known f, cx and cy.
#pragma once

#include <array>
#include <optional>
#include <span>

#include "moiregauge/geometry/camera.h"
#include "moiregauge/geometry/view.h"

namespace moiregauge::internal {

// Pose of the camera: X_cam = R(turn) (X, -Y, -Z) + shift for a board point (X, Y, Z) in mm. Camera axes are x right, y
// down, z forward.
struct Pose {
  std::array<double, 3> turn{};   // axis times angle, rad
  std::array<double, 3> shift{};  // mm
};

// Returns the view of the board plane from a pose.
[[nodiscard]] IdealFromBoard view_of(const Pose& pose, const Camera& camera);

// Returns the pose from which a camera with this f, cx, cy has this view. Exact if the view is an image of a plane by
// that camera, otherwise the nearest rotation.
[[nodiscard]] Pose pose_of(const IdealFromBoard& view, const Camera& camera);

// Returns the view of a known camera that sees three points of the board. Three points look alike from up to four
// poses. The result is the pose that Gauss-Newton reaches from `near`, the view of the previous frame.
// Fails (nothing): the points are on a line, or the camera has jumped.
[[nodiscard]] std::optional<IdealFromBoard> view_of_three(std::span<const BoardPoint> board,
                                                          std::span<const IdealPoint> ideal, const Camera& camera,
                                                          const IdealFromBoard& near);

}  // namespace moiregauge::internal
