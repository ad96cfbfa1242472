// SPDX-License-Identifier: Apache-2.0
// Draws a part of a grey image on a page, and maps its pixels to the page.
#pragma once

#include <string>

#include "moiregauge/drawing/surface/canvas.h"
#include "moiregauge/geometry/view.h"

namespace moiregauge::internal::figure {

using GreyView = ImageView<std::uint8_t>;

// Pixels of an image. (x, y) is the first one.
struct Part {
  int x = 0, y = 0, width = 0, height = 0;
};

class PictureBox {
 public:
  // Draws the part (shifted to be inside the image) with this width, points. Its height follows.
  PictureBox(Canvas& canvas, GreyView picture, Part part, Spot corner, double width);
  [[nodiscard]] Spot at(ImagePoint p) const;
  [[nodiscard]] double points_per_px() const { return scale_; }
  [[nodiscard]] Box box() const { return box_; }

 private:
  Box box_;
  Part part_;
  double scale_ = 1.0;
};

[[nodiscard]] inline Part whole(GreyView picture) { return {0, 0, picture.width, picture.height}; }
[[nodiscard]] Part square_round(ImagePoint centre, int side);

// Returns the image `now` as seen by the camera of the reference frame: mapped by the homographies through the board,
// with linear interpolation. Valid without lens distortion, as in the simulated figures. White outside of `now`.
[[nodiscard]] Image<std::uint8_t> stabilised(GreyView now, const IdealFromBoard& sees_now,
                                             const IdealFromBoard& sees_reference);

}  // namespace moiregauge::internal::figure
