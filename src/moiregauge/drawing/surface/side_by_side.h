// SPDX-License-Identifier: Apache-2.0
// A frame as filmed, and beside it the same with the camera's motion taken out and the targets' motion exaggerated: for
// people to see what the numbers say.
//
// Every pixel of the second picture belongs to a place p on the board, the place that the reference frame sees there.
// It shows what this frame sees of the place p - sum over targets of w(p) (N d - a): d the target's displacement, a by
// how much it seems to have moved when the camera's motion alone is taken out (d, but for a height above the board and
// the lens), N the factor; w is 1 on the target where it is drawn and falls to 0 round it. So a target is drawn moved
// by N d, what lies round it is stretched like rubber, and everything further off, the references too, stays where it
// is.
#pragma once

#include <string>
#include <vector>

#include "moiregauge/observation/reference/reference.h"

namespace moiregauge::internal {

// How one target is to be drawn in one frame.
struct DrawnMotion {
  bool is_known = false;              // false: as filmed
  Extent<frame::Board> displacement;  // d, mm
  Extent<frame::Board> apparent;      // a, mm
};

class SideBySide {
 public:
  // `exaggeration`: N >= 1. `longest_mm`: the largest |d| to come; it tells how far round a target must give way.
  SideBySide(const Reference& reference, double exaggeration, double longest_mm);

  // px, both even. The two stand side by side; of pictures more than twice as wide as high one above the other.
  [[nodiscard]] int width() const { return width_; }
  [[nodiscard]] int height() const { return height_; }
  [[nodiscard]] double exaggeration() const { return exaggeration_; }
  // Where the still picture stands in the whole, px, and how many of its pixels one of the filmed picture's is.
  [[nodiscard]] int still_x() const { return still_x_; }
  [[nodiscard]] int still_y() const { return still_y_; }
  [[nodiscard]] double scale() const { return scale_; }

  // `moves`: one per target in the site's order. view: how this frame sees the board; nullptr: it does not, and the
  // second picture is grey. words: what stands above the second picture, and above the first.
  [[nodiscard]] Image<std::uint8_t> draw(ImageView<std::uint8_t> filmed, const View* view,
                                         const std::vector<DrawnMotion>& moves, const std::string& words_filmed,
                                         const std::string& words_still) const;

 private:
  struct Target {
    BoardPoint centre;
    double half_width_mm = 0.0, half_height_mm = 0.0;  // along the board's axes
    double ring_mm = 0.0;                              // over which what lies round it gives way
  };
  [[nodiscard]] std::uint8_t still_pixel(ImageView<std::uint8_t> filmed, const View& view, std::size_t at,
                                         const std::vector<DrawnMotion>& moves) const;
  std::vector<Target> targets_;
  double exaggeration_ = 1.0, scale_ = 1.0;
  int part_width_ = 0, part_height_ = 0, samples_ = 1, letters_px_ = 0, width_ = 0, height_ = 0, still_x_ = 0,
      still_y_ = 0;
  std::vector<BoardPoint> places_;  // of every sample of every pixel of the still picture
};

// The round factor (1, 2, 5, 10, ... 10000) that shows a motion best: the largest that moves no target by more than a
// quarter of its size, and makes of its uncertainty no more than a twentieth. 1 where there is nothing to exaggerate.
[[nodiscard]] double best_exaggeration(double longest_mm, double u_mm, double size_mm);

}  // namespace moiregauge::internal
