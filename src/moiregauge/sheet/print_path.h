// SPDX-License-Identifier: Apache-2.0
// Draws a marker on cairo in mm. y is downwards.
#pragma once

#include "moiregauge/sheet/sheet_set.h"

struct _cairo;  // cairo_t, without cairo's header

namespace moiregauge::internal::sheet {

struct Ink {
  double density = 1.0;   // ink in dark areas: 1 is black, 0.6 a grey of 60 %
  bool inverted = false;  // light lines on dark (a circle stays dark for detection)
  // Exponent for cosine gratings: the grey value sent to the printer is light^(1 / gamma). A printer reproduces about
  // the 2.2nd power of it.
  // 1: a wave in grey values, for cameras that store luma in the same way (video, telephones). 2.2: a wave in light,
  // for cameras with linear output.
  double gamma = 1.0;
};

// Draws a grating of lines, squares or dots as one area with exact edges: only the printer's raster limits it. Cosine
// gratings are grey images (paint_cosines).
void print_grating(_cairo* cr, const Grating& grating, PagePoint centre, const Ink& ink);
void print_circle(_cairo* cr, double diameter_mm, PagePoint centre, const Ink& ink);

// Paints all cosine gratings of a sheet as one image of the page's size, at 300 dots per inch or 40 million dots. Their
// edges are clipped exactly.
// Renderers round an image's edges to whole dots. A small image would be stretched by up to one dot: 0.1 % of 40 mm at
// 600 dots per inch. For an image of the page it is a hundredth of that.
void paint_cosines(_cairo* cr, const Sheet& sheet, const Ink& ink);

// Returns the grey value (0 black, 1 white) of a cosine grating. x and y are in pitches from its symmetry point, a
// crest.
[[nodiscard]] double cosine_grey(double x, double y, const Ink& ink);

}  // namespace moiregauge::internal::sheet
