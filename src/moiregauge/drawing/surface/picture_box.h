// SPDX-License-Identifier: Apache-2.0
// A part of a grey picture on a page, and where its pixels lie there.
#pragma once

#include <string>

#include "moiregauge/drawing/surface/canvas.h"
#include "moiregauge/geometry/view.h"

namespace moiregauge::internal::figure {

using GreyView = ImageView<std::uint8_t>;

// Pixels of a picture, (x, y) the first one.
struct Part {
  int x = 0, y = 0, width = 0, height = 0;
};

class PictureBox {
 public:
  // Draws that part (kept inside the picture) as wide as `box.width`; its height follows.
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

// The picture `now` as the camera of the reference frame would have seen it: by the homographies through the board,
// interpolated linearly. Without a lens, as the simulated figures are. Outside of `now` it is white.
[[nodiscard]] Image<std::uint8_t> stabilised(GreyView now, const IdealFromBoard& sees_now,
                                             const IdealFromBoard& sees_reference);

}  // namespace moiregauge::internal::figure
