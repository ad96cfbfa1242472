// SPDX-License-Identifier: Apache-2.0
// A page of a figure on cairo, and the three files of a figure. Lengths are points (1/72 inch), y is downwards.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "moiregauge/image/image.h"
#include "moiregauge/units/point.h"

struct _cairo;  // cairo_t, without cairo's header

namespace moiregauge::internal::figure {

inline constexpr double kOneColumn = 89.0 * 72.0 / 25.4;  // a journal column of 89 mm
inline constexpr double kTwoColumns = 183.0 * 72.0 / 25.4;
inline constexpr double kTextSize = 7.0;

struct Colour {
  double r, g, b;
};
// Palette of Okabe and Ito (2008), which colour-blind readers can distinguish.
inline constexpr Colour kBlack{0.0, 0.0, 0.0}, kWhite{1.0, 1.0, 1.0}, kGrey{0.62, 0.62, 0.62}, kOrange{0.90, 0.62, 0.0},
    kSky{0.34, 0.71, 0.91}, kGreen{0.0, 0.62, 0.45}, kBlue{0.0, 0.45, 0.70}, kVermilion{0.84, 0.37, 0.0},
    kPurple{0.80, 0.47, 0.65};
// A colour has one meaning in overlay, figures, report (web/src/page.css) and mounting plan.
inline constexpr Colour kReferenceInk = kBlue, kTargetInk{0.88, 0.53, 0.0}, kAxisXInk{0.0, 0.48, 0.35},
                        kAxisYInk{0.66, 0.28, 0.49}, kCameraInk{0.18, 0.28, 0.34}, kNotOkInk{0.5, 0.5, 0.5};

struct Spot {
  double x = 0.0, y = 0.0;
};
struct Box {
  double x = 0.0, y = 0.0, width = 0.0, height = 0.0;
};
struct Stroke {
  Colour colour = kBlack;
  double width = 0.6;
  bool dashed = false;
};
enum class Align { kLeft, kCentre, kRight };
struct Letters {
  Align align = Align::kLeft;
  Colour colour = kBlack;
  bool bold = false;
  double angle_rad = 0.0;  // clockwise
  double size = kTextSize;
};

class Canvas {
 public:
  explicit Canvas(_cairo* cr) : cr_(cr) {}
  void line(const std::vector<Spot>& points, Stroke stroke);
  // Fills the area between two lines. Leaves a gap at points that are not finite.
  void band(const std::vector<Spot>& above, const std::vector<Spot>& below, Colour colour, double opacity);
  void dot(Spot at, double radius, Colour colour);
  void frame(Box box, Stroke stroke);
  void fill(Box box, Colour colour);
  // Draws an ellipse with semi-axes a and b. `angle_rad` is that of a, from x towards y.
  void ellipse(Spot centre, double a, double b, double angle_rad, Stroke stroke);
  void text(Spot at, const std::string& words, const Letters& letters = {});
  [[nodiscard]] double text_width(const std::string& words, const Letters& letters = {});
  void picture(ImageView<std::uint8_t> pixels, Box box);
  void clip(Box box);
  void unclip();

 private:
  void pen(Stroke stroke);
  _cairo* cr_;
};

struct Figure {
  double width = kOneColumn;
  double height = 0.0;
  std::function<void(Canvas&)> draw;
  double zoom = 1.0;  // factor of everything drawn: letters are zoom times kTextSize points
};
struct FigureFiles {
  std::string png, svg, pdf;  // bytes; empty if cairo is out of memory
};
[[nodiscard]] FigureFiles files_of(const Figure& figure);  // PNG: 300 dots per inch

}  // namespace moiregauge::internal::figure
