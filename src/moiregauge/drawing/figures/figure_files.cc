// SPDX-License-Identifier: Apache-2.0
// Writes one figure as three files.
#include <cmath>

#include <cairo-pdf.h>
#include <cairo-svg.h>
#include <cairo.h>

#include "moiregauge/drawing/surface/canvas.h"
#include "moiregauge/drawing/surface/surface.h"

namespace moiregauge::internal::figure {
namespace {

constexpr double kFigureDotsPerPoint = 300.0 / 72.0;

void draw_on(cairo_surface_t* surface, const Figure& figure, double scale) {
  const Context context(cairo_create(surface), cairo_destroy);
  cairo_scale(context.get(), scale, scale);
  cairo_set_source_rgb(context.get(), 1, 1, 1);
  cairo_paint(context.get());
  cairo_scale(context.get(), figure.zoom, figure.zoom);
  cairo_set_line_join(context.get(), CAIRO_LINE_JOIN_ROUND);
  Canvas canvas(context.get());
  figure.draw(canvas);
  cairo_show_page(context.get());
}

}  // namespace

FigureFiles files_of(const Figure& figure) {
  FigureFiles files;
  const auto dots = [](double points) { return static_cast<int>(std::ceil(points * kFigureDotsPerPoint)); };
  const Surface image(cairo_image_surface_create(CAIRO_FORMAT_RGB24, dots(figure.width), dots(figure.height)),
                      cairo_surface_destroy);
  draw_on(image.get(), figure, kFigureDotsPerPoint);
  if (cairo_surface_write_to_png_stream(image.get(), append_bytes, &files.png) != CAIRO_STATUS_SUCCESS)
    files.png.clear();
  const Surface svg(cairo_svg_surface_create_for_stream(append_bytes, &files.svg, figure.width, figure.height),
                    cairo_surface_destroy);
  draw_on(svg.get(), figure, 1.0);
  cairo_surface_finish(svg.get());
  const Surface pdf(cairo_pdf_surface_create_for_stream(append_bytes, &files.pdf, figure.width, figure.height),
                    cairo_surface_destroy);
  // A fixed date, so that the same run gives the same bytes.
  cairo_pdf_surface_set_metadata(pdf.get(), CAIRO_PDF_METADATA_CREATE_DATE, "2000-01-01T00:00:00Z");
  draw_on(pdf.get(), figure, 1.0);
  cairo_surface_finish(pdf.get());
  return files;
}

}  // namespace moiregauge::internal::figure
