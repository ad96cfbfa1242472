// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/drawing/figures/figure_pictures.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

namespace moiregauge::internal::figure {
namespace {

constexpr double kPicturesMargin = 4.0, kGap = 7.0, kTitle = 11.0;

void title(Canvas& canvas, Spot corner, const std::string& letter, const std::string& words) {
  canvas.text({corner.x, corner.y + 7.5}, letter, {.bold = true});
  canvas.text({corner.x + 15.0, corner.y + 7.5}, words);
}

void outline(Canvas& canvas, const PictureBox& box, const DetectedCircle& c, Stroke stroke) {
  const double minor = c.diameter_px * std::sqrt(c.axis_ratio), scale = 0.5 * box.points_per_px();
  canvas.ellipse(box.at(c.centre), scale * minor / c.axis_ratio, scale * minor, c.angle_rad, stroke);
}

void cross(Canvas& canvas, Spot p, double arm, Stroke stroke) {
  canvas.line({{p.x - arm, p.y}, {p.x + arm, p.y}}, stroke);
  canvas.line({{p.x, p.y - arm}, {p.x, p.y + arm}}, stroke);
}

// Draws text on a white plate, so that it is readable on any image.
void coordinates(Canvas& canvas, Spot at, const std::string& words) {
  const Letters letters{.align = Align::kCentre, .size = 6.0};
  const double width = canvas.text_width(words, letters) + 3.0;
  canvas.fill({at.x - 0.5 * width, at.y - 6.0, width, 8.0}, kWhite);
  canvas.text(at, words, letters);
}

void draw_circles(Canvas& canvas, const CirclesFigure& f, double width, double step) {
  Spot corner{kPicturesMargin, kPicturesMargin};
  const auto next = [&](const char* letter, const std::string& words) {
    title(canvas, corner, letter, words);
    const PictureBox box(canvas, f.picture, whole(f.picture), {corner.x, corner.y + kTitle}, width);
    corner.y += step;
    return box;
  };
  next("(a)", "Markers rotated by 20° about x and about y");
  const PictureBox outlines = next("(b)", fmt::format("{} outlines are ellipses (blue), {} are not (vermilion)",
                                                      f.search.circles.size(), f.search.rejected.size()));
  canvas.clip(outlines.box());
  for (const RejectedOutline& r : f.search.rejected) {
    const double radius = 0.5 * r.diameter_px * outlines.points_per_px();
    canvas.ellipse(outlines.at(r.centre), radius, radius, 0.0, {kVermilion, 0.5});
  }
  for (const DetectedCircle& c : f.search.circles) outline(canvas, outlines, c, {kBlue, 1.2});
  canvas.unclip();
  const PictureBox centres = next("(c)", "Centres, px");
  for (const DetectedCircle& c : f.search.circles) {
    const Spot p = centres.at(c.centre);
    cross(canvas, p, 4.0, {kVermilion, 0.8});
    const double above = 0.5 * c.diameter_px * centres.points_per_px() + 4.0;
    coordinates(canvas, {p.x, p.y - above}, fmt::format("{:.2f}, {:.2f}", c.centre.x, c.centre.y));
  }
}

std::vector<DetectedCircle> circles_of(const Observation& seen) {
  std::vector<DetectedCircle> circles;
  for (const MarkerObservation& m : seen.markers) {
    if (m.circle) circles.push_back(*m.circle);
  }
  return circles;
}

void draw_stages(Canvas& canvas, const StabilisedFigure& f, double width, double step) {
  const double right = kPicturesMargin + width + kGap;
  const auto put = [&](Spot corner, const char* letter, const std::string& words, GreyView picture) {
    title(canvas, corner, letter, words);
    return PictureBox(canvas, picture, whole(picture), {corner.x, corner.y + kTitle}, width);
  };
  const auto put_circles = [&](Spot corner, const char* letter, GreyView picture, const Observation& seen) {
    const PictureBox box = put(corner, letter, "Circles found", picture);
    for (const DetectedCircle& c : circles_of(seen)) {
      outline(canvas, box, c, {kVermilion, 0.9});
      cross(canvas, box.at(c.centre), 0.5 * c.diameter_px * box.points_per_px() + 1.5, {kVermilion, 0.5});
    }
  };
  put({kPicturesMargin, kPicturesMargin}, "(a)", "Reference frame", f.before);
  put({right, kPicturesMargin}, "(b)", fmt::format("Camera rotated by {}", f.turn), f.after);
  put_circles({kPicturesMargin, kPicturesMargin + step}, "(c)", f.before, f.reference->seen);
  put_circles({right, kPicturesMargin + step}, "(d)", f.after, *f.now);
  const auto& board = f.reference->view.ideal_from_board;
  const auto first = stabilised(f.after, f.now->stage1, board), second = stabilised(f.after, f.now->stage2, board);
  put({kPicturesMargin, kPicturesMargin + 2 * step}, "(e)",
      fmt::format("Stage 1 (circles), references within {:.3f} px", f.residual_px[0]), first.view());
  put({right, kPicturesMargin + 2 * step}, "(f)",
      fmt::format("Stage 2 (gratings), references within {:.3f} px", f.residual_px[1]), second.view());
}

// Draws a crop with a cross at the centre of the target in the reference frame, which makes movement visible.
void crop(Canvas& canvas, GreyView picture, Spot corner, double side) {
  const PictureBox box(canvas, picture, whole(picture), corner, side);
  const Box b = box.box();
  cross(canvas, {b.x + 0.5 * b.width, b.y + 0.5 * b.height}, 0.5 * b.width, {kVermilion, 0.5});
}

void draw_crops(Canvas& canvas, const CropsFigure& f, double side) {
  const double step = side + 4.0, left = kPicturesMargin + step;
  const double rows[] = {kPicturesMargin, kPicturesMargin + step + 2 * kTitle};
  title(canvas, {kPicturesMargin, rows[0]}, "(a)", fmt::format("{:.0f} s, reference", f.reference_time_s));
  crop(canvas, f.reference.view(), {kPicturesMargin, rows[0] + 2 * kTitle}, side);
  const auto size = [](GreyView v) { return fmt::format("{} × {} px", v.width, v.height); };
  title(canvas, {left, rows[0]}, "(b)", "As captured, " + size(f.shots.front().captured.view()));
  title(canvas, {left, rows[1]}, "(c)", "Stabilised by two stages, " + size(f.shots.front().held.view()));
  for (std::size_t i = 0; i < f.shots.size(); ++i) {
    const Shot& shot = f.shots[i];
    const double x = left + static_cast<double>(i) * step;
    const std::string time = fmt::format("{:.0f} s", shot.time_s);
    for (const int row : {0, 1}) {
      canvas.text({x + 0.5 * side, rows[row] + kTitle + 8.0}, time, {.align = Align::kCentre});
      crop(canvas, row == 0 ? shot.captured.view() : shot.held.view(), {x, rows[row] + 2 * kTitle}, side);
    }
  }
}

}  // namespace

Figure circles_found(const CirclesFigure& contents) {
  const double width = kOneColumn - 2 * kPicturesMargin;
  const double step = kTitle + width * contents.picture.height / contents.picture.width + kGap;
  return {kOneColumn, 2 * kPicturesMargin + 3 * step - kGap,
          [contents, width, step](Canvas& canvas) { draw_circles(canvas, contents, width, step); }};
}

Figure before_and_after(const StabilisedFigure& contents) {
  const double width = 0.5 * (kTwoColumns - 2 * kPicturesMargin - kGap);
  const double step = kTitle + width * contents.before.height / contents.before.width + kGap;
  return {kTwoColumns, 2 * kPicturesMargin + 3 * step - kGap,
          [contents, width, step](Canvas& canvas) { draw_stages(canvas, contents, width, step); }};
}

Figure crops_over_time(const CropsFigure& contents) {
  const double columns = 1.0 + static_cast<double>(contents.shots.size());
  const double side = (kTwoColumns - 2 * kPicturesMargin) / columns - 4.0;
  return {kTwoColumns, 2 * kPicturesMargin + 2 * (side + 2 * kTitle) + 4.0,
          [contents, side](Canvas& canvas) { draw_crops(canvas, contents, side); }};
}

}  // namespace moiregauge::internal::figure
