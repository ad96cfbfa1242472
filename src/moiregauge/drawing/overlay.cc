// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/drawing/overlay.h"

#include <algorithm>
#include <cmath>
#include <memory>

#include <cairo.h>
#include <fmt/format.h>

#include "moiregauge/units/units.h"

namespace moiregauge {
namespace {

struct Colour {
  double r, g, b;
};
// Okabe and Ito's colours: told apart by colour-blind readers too.
constexpr Colour kReferenceColour{0.34, 0.71, 0.91};
constexpr Colour kTargetColour{0.90, 0.62, 0.0};
constexpr Colour kRejectedColour{0.84, 0.37, 0.0};
constexpr Colour kUnusedColour{0.6, 0.6, 0.6};

using Surface = std::unique_ptr<cairo_surface_t, decltype(&cairo_surface_destroy)>;
using Context = std::unique_ptr<cairo_t, decltype(&cairo_destroy)>;

Surface grey_surface(ImageView<std::uint8_t> picture) {
  Surface surface(cairo_image_surface_create(CAIRO_FORMAT_RGB24, picture.width, picture.height), cairo_surface_destroy);
  cairo_surface_flush(surface.get());
  unsigned char* data = cairo_image_surface_get_data(surface.get());
  if (data == nullptr) return surface;
  const int stride = cairo_image_surface_get_stride(surface.get());
  for (int y = 0; y < picture.height; ++y) {
    auto* row = reinterpret_cast<std::uint32_t*>(data + static_cast<std::ptrdiff_t>(y) * stride);
    for (int x = 0; x < picture.width; ++x) row[x] = 0x010101u * picture.at(x, y);
  }
  cairo_surface_mark_dirty(surface.get());
  return surface;
}

// A pen that writes in picture coordinates: pixel (0,0) is the centre of the first pixel, cairo's is its corner.
class Pen {
 public:
  Pen(cairo_t* cr, double unit) : cr_(cr), unit_(unit) {}

  void colour(Colour c) { colour_ = c; }
  void ellipse(ImagePoint centre, double major, double minor, double angle) {
    cairo_save(cr_);
    cairo_translate(cr_, centre.x + 0.5, centre.y + 0.5);
    cairo_rotate(cr_, angle);
    cairo_scale(cr_, 0.5 * major, 0.5 * minor);
    cairo_new_sub_path(cr_);
    cairo_arc(cr_, 0, 0, 1, 0, kTurn);
    cairo_restore(cr_);
    stroke();
  }
  void cross(ImagePoint p, double half) {
    cairo_move_to(cr_, p.x + 0.5 - half, p.y + 0.5);
    cairo_line_to(cr_, p.x + 0.5 + half, p.y + 0.5);
    cairo_move_to(cr_, p.x + 0.5, p.y + 0.5 - half);
    cairo_line_to(cr_, p.x + 0.5, p.y + 0.5 + half);
    stroke();
  }
  void polygon(const std::vector<ImagePoint>& points) {
    for (const ImagePoint& p : points) cairo_line_to(cr_, p.x + 0.5, p.y + 0.5);
    cairo_close_path(cr_);
    stroke();
  }
  // Text on a dark plate, so that it can be read on any picture; kept inside the picture.
  void label(ImagePoint p, const std::string& text, double width, double height) {
    cairo_set_font_size(cr_, 11.0 * unit_);
    cairo_text_extents_t box;
    cairo_text_extents(cr_, text.c_str(), &box);
    const double pad = 3.0 * unit_;
    const double x = std::clamp(p.x, pad, std::max(pad, width - box.x_advance - pad));
    const double y = std::clamp(p.y, 14.0 * unit_, height - 2 * pad);
    cairo_set_source_rgba(cr_, 0, 0, 0, 0.65);
    cairo_rectangle(cr_, x - pad, y - 11.0 * unit_, box.x_advance + 2 * pad, 14.5 * unit_);
    cairo_fill(cr_);
    cairo_set_source_rgb(cr_, colour_.r, colour_.g, colour_.b);
    cairo_move_to(cr_, x, y);
    cairo_show_text(cr_, text.c_str());
    cairo_new_path(cr_);
  }

 private:
  void stroke() {
    cairo_set_line_width(cr_, 3.4 * unit_);  // a dark rim under the colour
    cairo_set_source_rgba(cr_, 0, 0, 0, 0.55);
    cairo_stroke_preserve(cr_);
    cairo_set_line_width(cr_, 1.6 * unit_);
    cairo_set_source_rgb(cr_, colour_.r, colour_.g, colour_.b);
    cairo_stroke(cr_);
  }
  cairo_t* cr_;
  double unit_;
  Colour colour_{1, 1, 1};
};

std::vector<ImagePoint> outline(const View& view, BoardPoint centre, double width, double height, double angle) {
  std::vector<ImagePoint> points;
  for (const auto& [sx, sy] : {std::pair{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}) {
    const double x = 0.5 * sx * width, y = 0.5 * sy * height;
    points.push_back(view({centre.x + x * std::cos(angle) - y * std::sin(angle),
                           centre.y + x * std::sin(angle) + y * std::cos(angle)}));
  }
  return points;
}

void draw_markers(Pen& pen, const Reference& reference, double width, double height, double unit) {
  for (std::size_t i = 0; i < reference.site.markers.size(); ++i) {
    const Marker& marker = reference.site.markers[i];
    const MarkerObservation& seen = reference.seen.markers[i];
    pen.colour(marker.role == Role::kReference ? kReferenceColour : kTargetColour);
    ImagePoint anchor{};
    if (marker.circle && seen.circle) {
      const SeenCircle& c = *seen.circle;
      const double minor = c.diameter_px * std::sqrt(c.axis_ratio);
      pen.ellipse(c.centre, minor / c.axis_ratio, minor, c.angle_rad);
      pen.cross(c.centre, 6.0 * unit);
      anchor = {c.centre.x - 0.5 * c.diameter_px, c.centre.y - 0.5 * c.diameter_px - 6.0 * unit};
    }
    if (marker.grating) {
      const Grating& g = *marker.grating;
      const auto corners = outline(reference.view, g.centre, g.width_mm, g.height_mm, g.angle_rad);
      pen.polygon(corners);
      const RasterPlan& plan = reference.plans[i];
      if (plan.side_px > 0) {
        const double side = plan.region_px * plan.step_mm;
        pen.polygon(outline(reference.view, g.centre, side, side, plan.angle_rad));
      }
      pen.cross(reference.view(g.centre), 6.0 * unit);
      if (!marker.circle) anchor = {corners[3].x, std::min(corners[3].y, corners[0].y) - 6.0 * unit};
    }
    pen.label(anchor, marker.name, width, height);
  }
}

cairo_status_t append(void* closure, const unsigned char* data, unsigned int length) {
  auto* bytes = static_cast<std::vector<std::uint8_t>*>(closure);
  bytes->insert(bytes->end(), data, data + length);
  return CAIRO_STATUS_SUCCESS;
}

}  // namespace

std::vector<std::uint8_t> draw_overlay(const OverlayContents& contents) {
  const Surface surface = grey_surface(contents.picture);
  if (cairo_surface_status(surface.get()) != CAIRO_STATUS_SUCCESS) return {};
  const Context context(cairo_create(surface.get()), cairo_destroy);
  cairo_select_font_face(context.get(), "DejaVu Sans", CAIRO_FONT_SLANT_NORMAL, CAIRO_FONT_WEIGHT_NORMAL);
  const double width = contents.picture.width, height = contents.picture.height;
  const double unit = std::max(1.0, std::max(width, height) / 1400.0);  // lines and letters grow with the picture
  Pen pen(context.get(), unit);
  constexpr std::size_t kMostRejected = 60;  // more would hide the picture
  // What was turned down matters only where something is missing.
  if (contents.circles != nullptr && contents.reference == nullptr) {
    const auto& rejected = contents.circles->rejected;
    for (std::size_t i = 0; i < std::min(rejected.size(), kMostRejected); ++i) {
      if (rejected[i].diameter_px < 10.0) continue;
      pen.colour(kRejectedColour);
      pen.ellipse(rejected[i].centre, rejected[i].diameter_px, rejected[i].diameter_px, 0.0);
      pen.label(rejected[i].centre, fmt::format("W {:.2f}", rejected[i].circularity), width, height);
    }
    pen.colour(kUnusedColour);
    for (const SeenCircle& c : contents.circles->circles) {
      const double minor = c.diameter_px * std::sqrt(c.axis_ratio);
      pen.ellipse(c.centre, minor / c.axis_ratio, minor, c.angle_rad);
    }
  }
  if (contents.reference != nullptr) draw_markers(pen, *contents.reference, width, height, unit);
  if (!contents.caption.empty()) {
    pen.colour({1, 1, 1});
    pen.label({8.0 * unit, 16.0 * unit}, contents.caption, width, height);
  }
  std::vector<std::uint8_t> bytes;
  cairo_surface_flush(surface.get());
  if (cairo_surface_write_to_png_stream(surface.get(), append, &bytes) != CAIRO_STATUS_SUCCESS) return {};
  return bytes;
}

}  // namespace moiregauge
