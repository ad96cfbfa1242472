// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "moiregauge/board/board_calibration.h"
#include "moiregauge/geometry/view.h"

namespace moiregauge::internal {

// The homography nearest to a view, the lens left in; empty when its points lie on a line.
[[nodiscard]] std::optional<IdealFromBoard> plane_view(const BoardView& view);

// The focal length for which the views are pictures of a plane, the principal point in the middle of the picture
// (Zhang 2000, two equations a view). Views that face the board say nothing: then 1.2 times the picture's larger side.
[[nodiscard]] double focal_length_of(std::span<const IdealFromBoard> views, int width, int height);

}  // namespace moiregauge::internal
