// SPDX-License-Identifier: Apache-2.0
// A marker's ink on cairo, where one unit is a millimetre and y grows downwards.
#pragma once

#include "moiregauge/sheet/sheet_set.h"

struct _cairo;  // cairo_t, kept out of our headers

namespace moiregauge::internal::sheet {

struct Ink {
  double density = 1.0;   // of what is dark: 1 is black, 0.6 a grey of 60 %
  bool inverted = false;  // light lines on dark (a circle stays dark: that is how it is found)
  // Cosine prints: the grey value sent to the printer is light^(1 / gamma); a printer gives back about its 2.2nd power.
  // 1: a wave in grey values, as cameras see it that store luma the same way (video, telephones); 2.2: a wave in light,
  // for cameras with linear output.
  double gamma = 1.0;
};

// A grating of lines, squares or dots as one area of ink with exact edges: what a printer's own raster makes of them is
// all that is lost. Cosines are greys: see paint_cosines.
void print_grating(_cairo* cr, const Grating& grating, PagePoint centre, const Ink& ink);
void print_circle(_cairo* cr, double diameter_mm, PagePoint centre, const Ink& ink);

// All cosine gratings of a sheet as one picture as large as the page, 300 dots an inch or 40 million dots: a renderer
// puts a picture's edges on whole dots of its own, so that a small one would be stretched by up to a dot (0.1 % of 40
// mm at 600 dots an inch), a page by a hundredth of that. The gratings' edges are cut exactly.
void paint_cosines(_cairo* cr, const Sheet& sheet, const Ink& ink);

// Grey value (0 black, 1 white) of a cosine print at a place in pitches from its symmetry point, a crest.
[[nodiscard]] double cosine_grey(double x, double y, const Ink& ink);

}  // namespace moiregauge::internal::sheet
