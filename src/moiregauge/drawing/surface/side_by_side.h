// SPDX-License-Identifier: Apache-2.0
// Draws a frame as recorded, and next to it the same frame without camera motion and with exaggerated target motion.
//
// Every pixel of the second image belongs to the board point p that the reference frame shows there. It shows this
// frame at the board point p - sum over targets of w(p) (N d - a).
// Here d is the target's displacement, and N the factor. The weight w is 1 on the target at its drawn position, and
// falls to 0 around it.
// The apparent displacement a is what remains after removing the camera motion only. It differs from d by height above
// the board and by the lens.
// So a target is drawn shifted by N d, its surroundings are stretched, and everything further away, references
// included, is at rest.
#pragma once

#include <string>
#include <vector>

#include "moiregauge/observation/reference/reference.h"

namespace moiregauge::internal {

// Motion of one target in one frame.
struct DrawnMotion {
  bool is_known = false;              // false: drawn as recorded
  Extent<frame::Board> displacement;  // d, mm
  Extent<frame::Board> apparent;      // a, mm
};

class SideBySide {
 public:
  // `exaggeration`: N >= 1. `longest_mm`: the largest |d| of the run, which determines the stretched area around a
  // target.
  SideBySide(const Reference& reference, double exaggeration, double longest_mm);

  // Page size, px, both even. The images are next to each other, or one above the other if they are more than twice as
  // wide as high.
  [[nodiscard]] int width() const { return width_; }
  [[nodiscard]] int height() const { return height_; }
  [[nodiscard]] double exaggeration() const { return exaggeration_; }
  // Position of the stabilised image on the page, px, and its pixels per pixel of the recorded image.
  [[nodiscard]] int still_x() const { return still_x_; }
  [[nodiscard]] int still_y() const { return still_y_; }
  [[nodiscard]] double scale() const { return scale_; }

  // Draws a page. `moves`: one per target in the site's order. `view`: the board as seen by this frame; nullptr:
  // unknown, and the second image is grey. `words_filmed` and `words_still`: titles of both images.
  [[nodiscard]] Image<std::uint8_t> draw(ImageView<std::uint8_t> filmed, const View* view,
                                         const std::vector<DrawnMotion>& moves, const std::string& words_filmed,
                                         const std::string& words_still) const;

 private:
  struct Target {
    BoardPoint centre;
    double half_width_mm = 0.0, half_height_mm = 0.0;  // along the board's axes
    double ring_mm = 0.0;                              // width of the stretched area around the target
  };
  [[nodiscard]] std::uint8_t still_pixel(ImageView<std::uint8_t> filmed, const View& view, std::size_t at,
                                         const std::vector<DrawnMotion>& moves) const;
  std::vector<Target> targets_;
  double exaggeration_ = 1.0, scale_ = 1.0;
  int part_width_ = 0, part_height_ = 0, samples_ = 1, letters_px_ = 0, width_ = 0, height_ = 0, still_x_ = 0,
      still_y_ = 0;
  std::vector<BoardPoint> places_;  // board points of all samples of all pixels of the stabilised image
};

// Returns the factor (1, 2, 5, 10, ... 10000) that shows a motion best. It is the largest factor that moves no target
// by more than a quarter of its size. The enlarged u is at most a twentieth of the size. Returns 1 if there is no
// motion.
[[nodiscard]] double best_exaggeration(double longest_mm, double u_mm, double size_mm);

}  // namespace moiregauge::internal
