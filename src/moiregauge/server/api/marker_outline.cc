// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/server/api/marker_outline.h"

#include <cmath>
#include <utility>

#include <nlohmann/json.hpp>

namespace moiregauge::internal {

nlohmann::ordered_json grating_outline(const View& view, const Grating& grating, Extent<frame::Board> shift) {
  const double c = std::cos(grating.angle_rad), s = std::sin(grating.angle_rad);
  nlohmann::ordered_json outline = nlohmann::ordered_json::array();
  for (const auto& [x, y] : {std::pair{-0.5, -0.5}, {0.5, -0.5}, {0.5, 0.5}, {-0.5, 0.5}}) {
    const double along_x = x * grating.width_mm, along_y = y * grating.height_mm;
    const ImagePoint corner = view(BoardPoint{grating.centre.x + shift.x + c * along_x - s * along_y,
                                              grating.centre.y + shift.y + s * along_x + c * along_y});
    outline.push_back({corner.x, corner.y});
  }
  return outline;
}

}  // namespace moiregauge::internal
