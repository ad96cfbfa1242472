// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/sheet/mounting_plan.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "moiregauge/drawing/surface/canvas.h"
#include "moiregauge/sheet/draw_sheet.h"
#include "moiregauge/units/units.h"

namespace moiregauge::internal::sheet {
namespace {

using figure::Align;
using figure::Canvas;
using figure::Colour;
using figure::kBlack;
using figure::kGrey;
using figure::Letters;

constexpr double kLeft = 15.0, kRight = 282.0, kPlanText_mm = 3.2, kPlanSmall_mm = 2.7, kLine_mm = 4.6;
constexpr double kDrawingTop = 24.0, kDrawingHigh = 82.0;
constexpr std::size_t kMaxRows = 16;  // in the table; more markers are in site.toml only

Colour colour_of(const Marker& marker) {
  return marker.role == Role::kReference ? figure::kReferenceInk : figure::kTargetInk;
}

// Map from the board to its drawing.
struct Scale {
  double mm_per_mm;
  BoardPoint middle;
  double x, y;
  [[nodiscard]] figure::Spot at(BoardPoint p) const {
    return {x + mm_per_mm * (p.x - middle.x), y - mm_per_mm * (p.y - middle.y)};
  }
};

Scale scale_for(const Box& box) {
  const double wide = kRight - kLeft - 40.0, high = kDrawingHigh - 24.0;
  return {std::min(wide / box.width(), high / box.height()), box.middle(), 0.5 * (kLeft + kRight),
          kDrawingTop + 0.5 * kDrawingHigh};
}

// Marks the origin at its position. The arrows are drawn separately, clear of the markers.
void draw_axes(Canvas& canvas, const Scale& scale) {
  const figure::Spot o = scale.at({0.0, 0.0});
  canvas.line({{o.x - 1.5, o.y}, {o.x + 1.5, o.y}}, {kBlack, 0.2});
  canvas.line({{o.x, o.y - 1.5}, {o.x, o.y + 1.5}}, {kBlack, 0.2});
  constexpr double kArm = 9.0;
  const figure::Spot corner{kRight - 14.0, kDrawingTop + 16.0};
  const auto arrow = [&](double dx, double dy, const char* name) {
    const figure::Spot tip{corner.x + kArm * dx, corner.y + kArm * dy};
    canvas.line({corner, tip}, {kBlack, 0.3});
    canvas.line({{tip.x - 1.5 * dx - 0.8 * dy, tip.y - 1.5 * dy - 0.8 * dx},
                 tip,
                 {tip.x - 1.5 * dx + 0.8 * dy, tip.y - 1.5 * dy + 0.8 * dx}},
                {kBlack, 0.3});
    canvas.text({tip.x + 1.6 * dx - 0.8, tip.y + 1.6 * dy + 0.9}, name,
                {Align::kLeft, kBlack, false, 0.0, kPlanSmall_mm});
  };
  arrow(1.0, 0.0, "x");
  arrow(0.0, -1.0, "y");
  canvas.text({corner.x + kArm, corner.y + 5.0}, "+ in the drawing: origin",
              {Align::kRight, kBlack, false, 0.0, kPlanSmall_mm});
}

void draw_marker(Canvas& canvas, const Scale& scale, const Marker& marker) {
  const double s = scale.mm_per_mm;
  if (marker.grating) {
    const Grating& g = *marker.grating;
    const double c = std::cos(g.angle_rad), n = std::sin(g.angle_rad), x = 0.5 * g.width_mm, y = 0.5 * g.height_mm;
    std::vector<figure::Spot> corners;
    for (const auto& [i, k] : {std::pair{-1, -1}, {1, -1}, {1, 1}, {-1, 1}, {-1, -1}})
      corners.push_back(scale.at({g.centre.x + i * x * c - k * y * n, g.centre.y + i * x * n + k * y * c}));
    canvas.line(corners, {colour_of(marker), 0.5});
  }
  if (marker.circle)
    canvas.dot(scale.at(marker.circle->centre), std::max(0.6, 0.5 * s * marker.circle->diameter_mm), colour_of(marker));
  const Box box = extent_of(marker);
  const figure::Spot top = scale.at({box.middle().x, box.high.y});
  canvas.text({top.x, top.y - 1.4}, marker.name, {Align::kCentre, colour_of(marker), true, 0.0, kPlanSmall_mm});
}

// Draws the distances of the outermost reference circles, or gratings if there are none.
void draw_dimensions(Canvas& canvas, const Scale& scale, const SheetSet& set) {
  BoardPoint low{1e300, 1e300}, high{-1e300, -1e300};
  for (const Marker& m : set.site.markers) {
    if (m.role != Role::kReference) continue;
    const BoardPoint p = m.circle ? m.circle->centre : m.grating->centre;
    low = {std::min(low.x, p.x), std::min(low.y, p.y)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y)};
  }
  const Box box = extent_of(set.site.markers);
  if (!(high.x > low.x)) return;
  const double below = scale.at(box.low).y + 6.0, left_of = scale.at(box.low).x - 6.0;
  const double x0 = scale.at(low).x, x1 = scale.at(high).x, y0 = scale.at(low).y, y1 = scale.at(high).y;
  const auto tick = [&](double x, double y, bool upright) {
    canvas.line(
        {{x - (upright ? 0 : 1.2), y - (upright ? 1.2 : 0)}, {x + (upright ? 0 : 1.2), y + (upright ? 1.2 : 0)}},
        {kGrey, 0.25});
  };
  canvas.line({{x0, below}, {x1, below}}, {kGrey, 0.25});
  tick(x0, below, true), tick(x1, below, true);
  canvas.text({0.5 * (x0 + x1), below + 3.6}, fmt::format("{:g} mm", high.x - low.x),
              {Align::kCentre, kBlack, false, 0.0, kPlanSmall_mm});
  if (!(high.y > low.y)) return;
  canvas.line({{left_of, y0}, {left_of, y1}}, {kGrey, 0.25});
  tick(left_of, y0, false), tick(left_of, y1, false);
  canvas.text({left_of - 1.5, 0.5 * (y0 + y1) + 1.0}, fmt::format("{:g} mm", high.y - low.y),
              {Align::kRight, kBlack, false, 0.0, kPlanSmall_mm});
}

std::string place(const std::optional<BoardPoint>& p) { return p ? fmt::format("{:+.1f}, {:+.1f}", p->x, p->y) : "-"; }

void draw_table(Canvas& canvas, const SheetSet& set, double top) {
  const double columns[] = {kLeft, kLeft + 17.0, kLeft + 39.0, kLeft + 72.0, kLeft + 105.0, kLeft + 125.0};
  const auto row = [&](double y, const std::vector<std::string>& cells, bool bold) {
    for (std::size_t i = 0; i < cells.size(); ++i)
      canvas.text({columns[i], y}, cells[i],
                  fitted(canvas, cells[i], {Align::kLeft, kBlack, bold, 0.0, kPlanSmall_mm},
                         columns[i + 1] - columns[i] - 1.0));
  };
  row(top, {"name", "role", "circle x, y (mm)", "grating x, y (mm)", "size (mm)"}, true);
  canvas.line({{kLeft, top + 1.3}, {kLeft + 122.0, top + 1.3}}, {kGrey, 0.2});
  for (std::size_t i = 0; i < std::min(kMaxRows, set.site.markers.size()); ++i) {
    const Marker& m = set.site.markers[i];
    row(top + 1.0 + kLine_mm * static_cast<double>(i + 1),
        {m.name, m.role == Role::kReference ? "reference" : "target",
         place(m.circle ? std::optional(m.circle->centre) : std::nullopt),
         place(m.grating ? std::optional(m.grating->centre) : std::nullopt),
         m.grating ? fmt::format("{:g} x {:g}", m.grating->width_mm, m.grating->height_mm) : "-"},
        false);
  }
  if (set.site.markers.size() > kMaxRows)
    canvas.text({kLeft, top + 1.0 + kLine_mm * (kMaxRows + 1.0)},
                fmt::format("and {} more: see site.toml", set.site.markers.size() - kMaxRows),
                {Align::kLeft, kBlack, false, 0.0, kPlanSmall_mm});
}

std::vector<std::string> advice(const SheetSet& set) {
  const bool is_one = set.sheets.size() == 1 && set.site.markers.size() > 1;
  const bool is_tiled = std::ranges::any_of(set.sheets, [](const Sheet& sheet) { return sheet.tiling.has_value(); });
  const KnownTo& known = set.site.known_to;
  std::vector<std::string> lines{
      "1  Print sheets.pdf at 100 % on matt paper. Measure both rulers. If one",
      "   is not 100.0 mm long, pass --print-scale (measured / 100).",
      is_tiled ? "2  Join the parts of each marker on a stiff, flat plate, from left to right."
               : "2  Glue the paper flat on stiff plates (aluminium, dibond), without waves.",
      is_one ? "3  Cut out the targets and fix them to what moves. Leave the references"
             : "3  Mount every sheet at its position in the table, arrow upwards.",
      is_one ? "   on their sheet if you can: their relative positions are then exact."
             : "   Use a level and a tape. site.toml assumes that positions are known to",
      is_one ? "   Mount markers that you cut apart at the positions in the table."
             : fmt::format("   {:g} mm and angles to {:.2g} deg: enter what you achieved in [known_to].",
                           known.position_mm, degrees_from_radians(known.rotation_rad)),
      "4  Fix the references (blue) to the ground or an abutment. Targets",
      "   (orange) may move. Mount all in one plane, facing the camera.",
      "5  If a target is in front of that plane or behind it, enter its z_mm",
      "   in site.toml (positive towards the camera).",
      "6  Film, then run: moiregauge measure CLIP --site site.toml",
  };
  return lines;
}

}  // namespace

Paper plan_paper() { return turned(*standard_paper("A4")); }

void draw_mounting_plan(_cairo* cr, const SheetSet& set) {
  Canvas canvas(cr);
  canvas.text({kLeft, 14.0}, "Mounting plan", {Align::kLeft, kBlack, true, 0.0, 6.0});
  canvas.text({kLeft, 20.0}, fmt::format("{}; seen from the camera, x right, y up", words_for_prints(set.site.markers)),
              {Align::kLeft, kBlack, false, 0.0, kPlanText_mm});
  const Scale scale = scale_for(extent_of(set.site.markers));
  for (const Marker& marker : set.site.markers) draw_marker(canvas, scale, marker);
  draw_dimensions(canvas, scale, set);
  draw_axes(canvas, scale);
  const double top = kDrawingTop + kDrawingHigh + 12.0;
  draw_table(canvas, set, top);
  double y = top;
  for (const std::string& line : advice(set)) {
    canvas.text({kLeft + 140.0, y}, line, {Align::kLeft, kBlack, false, 0.0, kPlanText_mm});
    y += 1.15 * kLine_mm;
  }
}

}  // namespace moiregauge::internal::sheet
