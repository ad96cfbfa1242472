// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "moiregauge/board/board_calibration.h"
#include "moiregauge/geometry/view.h"

namespace moiregauge::internal {

// Fits a homography to a view without a lens. Nothing if its points are on a line.
[[nodiscard]] std::optional<IdealFromBoard> plane_view(const BoardView& view);

// Returns the focal length from the homographies, px (Zhang 2000, two equations a view). The principal point is the
// middle of the image. Views that face the board do not show f. The result is then 1.2 times the image's larger side.
[[nodiscard]] double focal_length_of(std::span<const IdealFromBoard> views, int width, int height);

}  // namespace moiregauge::internal
