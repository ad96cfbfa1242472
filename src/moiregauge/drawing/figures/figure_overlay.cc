// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/drawing/figures/figure_overlay.h"

#include <algorithm>
#include <cmath>
#include <memory>

#include <fmt/format.h>

#include "moiregauge/drawing/overlays/scale_bar.h"
#include "moiregauge/units/units.h"

namespace moiregauge::internal::figure {
namespace {

constexpr double kPictureDotsPerPoint = 350.0 / 72.0;  // above a printer's screen resolution

// Returns the image reduced by averaging n x n pixels, with the smallest n that gives at most `widest_px`.
Image<std::uint8_t> shrunk(ImageView<std::uint8_t> picture, double widest_px) {
  const int n = std::max(1, static_cast<int>(std::ceil(picture.width / widest_px)));
  Image<std::uint8_t> out(picture.width / n, picture.height / n);
  for (int y = 0; y < picture.height / n; ++y) {
    for (int x = 0; x < picture.width / n; ++x) {
      int sum = 0;
      for (int row = 0; row < n; ++row)
        for (int column = 0; column < n; ++column)
          sum += picture.row(y * n + row)[static_cast<std::size_t>(x * n + column)];
      out.at(x, y) = static_cast<std::uint8_t>((sum + n * n / 2) / (n * n));
    }
  }
  return out;
}

struct Outline {
  std::vector<std::vector<ImagePoint>> lines;  // closed lines
  std::string name;
  Role role = Role::kReference;
};

std::vector<ImagePoint> seen_along(const View& view, BoardPoint centre,
                                   const std::vector<Extent<frame::Board>>& round) {
  std::vector<ImagePoint> points;
  points.reserve(round.size());
  for (const auto& e : round) points.push_back(view(centre + e));
  points.push_back(points.front());
  return points;
}

std::vector<Outline> outlines_of(const Reference& reference) {
  constexpr int kCorners = 48;
  std::vector<Outline> outlines;
  for (const Marker& marker : reference.site.markers) {
    Outline outline{{}, marker.name, marker.role};
    if (marker.circle && marker.circle->diameter_mm > 0.0) {
      std::vector<Extent<frame::Board>> round;
      round.reserve(kCorners);
      for (int i = 0; i < kCorners; ++i)
        round.push_back({0.5 * marker.circle->diameter_mm * std::cos(kTwoPi * i / kCorners),
                         0.5 * marker.circle->diameter_mm * std::sin(kTwoPi * i / kCorners)});
      outline.lines.push_back(seen_along(reference.view, marker.circle->centre, round));
    }
    if (marker.grating) {
      const Grating& g = *marker.grating;
      const double c = std::cos(g.angle_rad), s = std::sin(g.angle_rad);
      std::vector<Extent<frame::Board>> corners;
      for (const auto& [x, y] : {std::pair{-0.5, -0.5}, {0.5, -0.5}, {0.5, 0.5}, {-0.5, 0.5}})
        corners.push_back({x * g.width_mm * c - y * g.height_mm * s, x * g.width_mm * s + y * g.height_mm * c});
      outline.lines.push_back(seen_along(reference.view, g.centre, corners));
    }
    outlines.push_back(std::move(outline));
  }
  return outlines;
}

// Draws text with a white outline, so that it is readable on any image.
void outlined_text(Canvas& canvas, Spot at, const std::string& words, Letters letters) {
  const Colour ink = letters.colour;
  letters.colour = kWhite;
  for (const auto& [x, y] :
       {std::pair{-0.7, 0.0}, {0.7, 0.0}, {0.0, -0.7}, {0.0, 0.7}, {-0.5, -0.5}, {0.5, -0.5}, {-0.5, 0.5}, {0.5, 0.5}})
    canvas.text({at.x + x, at.y + y}, words, letters);
  letters.colour = ink;
  canvas.text(at, words, letters);
}

struct Contents {
  Image<std::uint8_t> picture;
  std::vector<Outline> outlines;
  double points_per_px = 1.0;  // per pixel of the original image
  double points_per_mm = 1.0;  // per mm on the board at the image centre
  Spot size;                   // the image's size on the page
};

void draw_contents(Canvas& canvas, const Contents& c) {
  canvas.picture(c.picture.view(), {0.0, 0.0, c.size.x, c.size.y});
  for (const Outline& outline : c.outlines) {
    const Colour ink = outline.role == Role::kReference ? kReferenceInk : kTargetInk;
    double left = c.size.x, right = 0.0, top = c.size.y;
    for (const auto& line : outline.lines) {
      std::vector<Spot> points;
      points.reserve(line.size());
      for (const ImagePoint& p : line) points.push_back({(p.x + 0.5) * c.points_per_px, (p.y + 0.5) * c.points_per_px});
      canvas.line(points, {kWhite, 1.8});
      canvas.line(points, {ink, 0.9});
      for (const Spot& p : points) {
        left = std::min(left, p.x);
        right = std::max(right, p.x);
        top = std::min(top, p.y);
      }
    }
    const double half = 0.5 * canvas.text_width(outline.name, {.bold = true}) + 1.0;
    const double x = std::clamp(0.5 * (left + right), half, std::max(half, c.size.x - half));
    outlined_text(canvas, {x, std::max(kTextSize, top - 2.5)}, outline.name,
                  {.align = Align::kCentre, .colour = ink, .bold = true});
  }
  const double bar_mm = round_length(0.25 * c.size.x / c.points_per_mm), bar = bar_mm * c.points_per_mm;
  const Spot foot{c.size.x - 4.0, c.size.y - 4.0};
  canvas.line({{foot.x - bar, foot.y}, foot}, {kWhite, 2.6});
  canvas.line({{foot.x - bar, foot.y}, foot}, {kBlack, 1.4});
  outlined_text(canvas, {foot.x - 0.5 * bar, foot.y - 3.0}, fmt::format("{:g} mm", bar_mm), {.align = Align::kCentre});
}

}  // namespace

Figure overlay_figure(const Reference& reference, ImageView<std::uint8_t> picture, double width, double zoom) {
  const auto contents = std::make_shared<Contents>();
  contents->picture = shrunk(picture, width * kPictureDotsPerPoint);
  contents->outlines = outlines_of(reference);
  contents->points_per_px = width / zoom / picture.width;
  const BoardPoint middle = reference.view.board({0.5 * picture.width, 0.5 * picture.height});
  contents->points_per_mm = contents->points_per_px / reference.view.mm_per_px(middle);
  contents->size = {width / zoom, width / zoom * picture.height / picture.width};
  return {width, zoom * contents->size.y, [contents](Canvas& canvas) { draw_contents(canvas, *contents); }, zoom};
}

}  // namespace moiregauge::internal::figure
