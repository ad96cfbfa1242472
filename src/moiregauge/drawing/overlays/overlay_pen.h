// SPDX-License-Identifier: Apache-2.0
// Draws overlays: an image enlarged by an integer factor, and a pen that accepts image coordinates.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <cairo.h>

#include "moiregauge/detection/circles/circles.h"
#include "moiregauge/drawing/surface/surface.h"
#include "moiregauge/geometry/view.h"
#include "moiregauge/image/image.h"
#include "moiregauge/site/site.h"

namespace moiregauge::internal::overlay {

struct Colour {
  double r, g, b;
};
// Palette of Okabe and Ito (2008), which colour-blind readers can distinguish.
inline constexpr Colour kReferenceColour{0.34, 0.71, 0.91}, kTargetColour{0.90, 0.62, 0.0},
    kRejectedColour{1.0, 0.47, 0.16}, kUnusedColour{0.6, 0.6, 0.6}, kLatticeColour{0.0, 0.75, 0.55},
    kUnidentifiedColour{0.94, 0.89, 0.26}, kWhite{1.0, 1.0, 1.0};

// Returns a page of width x height px with the image in the upper left corner. Each image pixel has `scale` x `scale`
// px.
[[nodiscard]] Surface page_with(ImageView<std::uint8_t> picture, int scale, int width, int height);

// A rectangle on the page, px.
struct Box {
  double x = 0.0, y = 0.0, width = 0.0, height = 0.0;
  [[nodiscard]] double shared_with(const Box& o) const;  // common area, px^2
  [[nodiscard]] double distance_to(double px, double py) const;
  [[nodiscard]] Box grown(double by) const { return {x - by, y - by, width + 2.0 * by, height + 2.0 * by}; }
};

// Pixel (0,0) of the image is the centre of its first pixel, cairo's is its corner. `unit` is the scale of lines and
// letters: 1 on a page of about 1400 px width.
class Pen {
 public:
  Pen(cairo_t* cr, double unit, int scale = 1);

  void colour(Colour c) { colour_ = c; }
  void dashed(bool on) { dashed_ = on; }
  void width(double units) { width_ = units; }
  void ellipse(const DetectedCircle& circle);
  void circle(ImagePoint centre, double diameter_px);
  void cross(ImagePoint p, double half_units);
  void polygon(const std::vector<ImagePoint>& points);
  void line(ImagePoint a, ImagePoint b);
  void arrow(ImagePoint a, ImagePoint b);
  void dot(ImagePoint p, double radius_units);
  // Draws a horizontal bar with ends from x0 to x1 at y (page px).
  void bar(double x0, double x1, double y, double width_units, double end_units);

  // Draws text on a dark plate. (x, y) is the baseline start of the first line (page px). The plate is kept inside
  // `within`. '\n' separates lines.
  void label(double x, double y, const std::string& text, const Box& within);
  // Draws such a text next to an object with these corners, at the position that covers the smallest reserved area.
  // Draws nothing if that exceeds `most_covered`, a share of the label's area.
  void label_outside(const std::vector<ImagePoint>& about, const std::string& text, const Box& within,
                     double most_covered = 1e9);
  // Reserves a part of the page, which labels should not cover.
  void keep_free(const Box& box) { taken_.push_back(box); }
  [[nodiscard]] double covered(const Box& box) const;  // reserved area, page px^2
  void letters(double units, bool bold);

  [[nodiscard]] double text_width(const std::string& line) const;
  [[nodiscard]] double line_height() const { return 1.3 * letters_ * unit_; }
  [[nodiscard]] double unit() const { return unit_; }
  [[nodiscard]] double page_x(double picture_x) const { return (picture_x + 0.5) * scale_; }
  [[nodiscard]] double page_y(double picture_y) const { return (picture_y + 0.5) * scale_; }
  [[nodiscard]] Box page_box(const std::vector<ImagePoint>& points) const;

 private:
  void stroke();
  [[nodiscard]] Box plate(double x, double y, const std::string& text) const;
  cairo_t* cr_;
  double unit_;
  double scale_;
  double width_ = 1.6;
  double letters_ = 11.0;
  bool dashed_ = false;
  Colour colour_{1, 1, 1};
  std::vector<Box> taken_;
};

// Returns the corners of the square around a circle.
[[nodiscard]] std::vector<ImagePoint> corners_round(ImagePoint centre, double diameter_px);
// Returns the corners of a rectangle on the board, projected into the image.
[[nodiscard]] std::vector<ImagePoint> outline(const View& view, BoardPoint centre, double width, double height,
                                              double angle);

}  // namespace moiregauge::internal::overlay
