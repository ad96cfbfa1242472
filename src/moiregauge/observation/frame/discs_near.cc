// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/observation/frame/discs_near.h"

#include "moiregauge/observation/frame/disc_centre.h"

namespace moiregauge::internal {

std::optional<CircleSearch> discs_near(const GreyPicture& picture, const Reference& reference,
                                       const IdealFromBoard& expected, Rows rows, Identified& who) {
  const View view{expected, reference.lens};
  CircleSearch search;
  who.circle_of_marker.assign(reference.site.markers.size(), -1);
  who.image_from_board = Homography<frame::Image, frame::Board>(expected.matrix());
  for (const CirclePoint& point : reference.circles) {
    DetectedCircle circle = *reference.seen.markers[point.marker].circle;
    circle.diameter_px = reference.diameter_px(point, view);
    const auto centre = disc_centre(picture.luma, view(point.board), circle.diameter_px, circle, rows);
    if (!centre) return std::nullopt;
    circle.centre = *centre;
    who.circle_of_marker[point.marker] = static_cast<int>(search.circles.size());
    search.circles.push_back(circle);
  }
  return search;
}

}  // namespace moiregauge::internal
