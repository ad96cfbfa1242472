// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/drawing/overlays/overlay_inspection.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "moiregauge/drawing/overlays/inspection_text.h"
#include "moiregauge/drawing/overlays/overlay_pen.h"
#include "moiregauge/drawing/overlays/scale_bar.h"
#include "moiregauge/drawing/surface/png_bytes.h"

namespace moiregauge::internal {
namespace {

using namespace overlay;

// Smallest page width with enough space for texts (chosen). Smaller images are enlarged.
constexpr double kReadableWidth_px = 1200.0;
constexpr std::size_t kMaxRejected = 60;  // drawn outlines; more would hide the image (chosen)
constexpr std::size_t kMaxReasons = 24;   // rejected outlines with a label (chosen)
constexpr double kMaxCovered = 0.05;      // largest covered share of such a label
constexpr double kLetterSize = 12.0;

using Corners = std::vector<ImagePoint>;

Colour colour_of(const Inspection& seen, int marker) {
  if (marker == kUnidentified) return kUnidentifiedColour;
  const Marker& m = seen.reference->site.markers[static_cast<std::size_t>(marker)];
  return m.role == Role::kReference ? kReferenceColour : kTargetColour;
}

std::vector<const RejectedOutline*> rejected_to_draw(const Inspection& seen) {
  std::vector<const RejectedOutline*> out = rejected_elsewhere(seen);
  out.resize(std::min(out.size(), kMaxRejected));
  return out;
}

class InspectionDrawing {
 public:
  InspectionDrawing(const InspectionOverlay& contents, Pen& pen, const Box& picture)
      : contents_(contents), seen_(contents.seen), pen_(pen), picture_(picture) {}

  void draw() {
    reserve();
    draw_lattices();
    draw_rejected();
    draw_patches();
    draw_circles();
    draw_axes();
    name_markers();
    draw_scale();
    name_the_rest();
  }

 private:
  // Reserves the objects' areas, so that labels do not cover them.
  void reserve() {
    for (const InspectedPatch& p : seen_.patches) pen_.keep_free(pen_.page_box(corners_of(p)));
    for (const InspectedCircle& c : seen_.circles) pen_.keep_free(box_of(c.seen));
    for (const IndexedLattice& l : seen_.lattices) pen_.keep_free(pen_.page_box(corners_of(l)));
  }
  static Corners corners_of(const InspectedPatch& p) { return {p.seen.outline.begin(), p.seen.outline.end()}; }
  static Corners corners_of(const IndexedLattice& lattice) {
    Corners points;
    for (const LatticePoint& p : lattice.points) points.push_back(p.at);
    return points;
  }
  // Returns the corners next to which a lattice is labelled: those of its grating, if it is part of one.
  [[nodiscard]] Corners about(const IndexedLattice& lattice) const {
    Corners points = corners_of(lattice);
    for (const InspectedPatch& p : seen_.patches) {
      if (std::all_of(points.begin(), points.end(), [&](ImagePoint at) { return holds(p.seen, at); }))
        return corners_of(p);
    }
    return points;
  }
  [[nodiscard]] Box box_of(const DetectedCircle& c) const {
    return pen_.page_box(corners_round(c.centre, c.diameter_px));
  }

  void draw_lattices() {
    pen_.colour(kLatticeColour);
    for (const IndexedLattice& lattice : seen_.lattices) {
      pen_.width(0.8);
      for (const LatticePoint& p : lattice.points) {
        if (const auto* right = lattice.find(p.column + 1, p.row)) pen_.line(p.at, right->at);
        if (const auto* below = lattice.find(p.column, p.row + 1)) pen_.line(p.at, below->at);
      }
      for (const LatticePoint& p : lattice.points) pen_.dot(p.at, p.column == 0 && p.row == 0 ? 4.5 : 2.2);
    }
    pen_.width(1.6);
  }
  void draw_rejected() {
    pen_.colour(kRejectedColour);
    pen_.dashed(true);
    for (const RejectedOutline* r : rejected_to_draw(seen_)) pen_.circle(r->centre, r->diameter_px + 4.0);
    pen_.dashed(false);
  }
  void draw_patches() {
    for (const InspectedPatch& p : seen_.patches) {
      pen_.colour(colour_of(seen_, p.marker));
      pen_.polygon(corners_of(p));
    }
  }
  void draw_circles() {
    for (const InspectedCircle& c : seen_.circles) {
      if (c.lattice != kUnidentified && c.marker == kUnidentified) continue;
      pen_.colour(colour_of(seen_, c.marker));
      pen_.ellipse(c.seen);
      pen_.cross(c.seen.centre, 4.0);
    }
  }
  void draw_axes() {
    if (!seen_.reference) return;
    const View& view = seen_.reference->view;
    const double length_px = 0.025 * std::max(seen_.width, seen_.height);
    const double mm = length_px * view.mm_per_px({0.0, 0.0});
    pen_.colour(kWhite);
    pen_.letters(kLetterSize, true);
    for (const auto& [tip, letter] : {std::pair{BoardPoint{mm, 0.0}, "x"}, {BoardPoint{0.0, mm}, "y"}}) {
      const ImagePoint end = view(tip);
      if (!std::isfinite(end.x) || !std::isfinite(end.y)) continue;
      pen_.arrow(view({0.0, 0.0}), end);
      pen_.keep_free(pen_.page_box({view({0.0, 0.0}), end}).grown(3.0 * pen_.unit()));
      pen_.label_outside({end}, letter, picture_);
    }
  }
  // Draws one label for both the circle and the grating of a marker.
  void name_markers() {
    for (std::size_t i = 0; seen_.reference && i < seen_.reference->site.markers.size(); ++i) {
      const int marker = static_cast<int>(i);
      Corners about;
      std::string words = name_of(seen_, marker);
      for (const InspectedCircle& c : seen_.circles) {
        if (c.marker != marker) continue;
        about = corners_round(c.seen.centre, c.seen.diameter_px);
      }
      for (const InspectedPatch& p : seen_.patches) {
        if (p.marker != marker) continue;
        about.insert(about.end(), p.seen.outline.begin(), p.seen.outline.end());
        words += "  " + short_text(p);
      }
      if (about.empty()) {  // a marker of the site that was not detected
        about.push_back(seen_.reference->view(place_of(i)));
        words += "  not found";
      }
      pen_.colour(colour_of(seen_, marker));
      pen_.letters(kLetterSize, true);
      pen_.label_outside(about, words, picture_);
    }
  }
  void draw_scale() {
    if (!seen_.reference) return;
    pen_.letters(kLetterSize, false);
    draw_scale_bar(pen_, *seen_.reference, seen_.pitch_of_unit, word_for(seen_.unit), picture_);
  }
  [[nodiscard]] BoardPoint place_of(std::size_t i) const {
    const Marker& m = seen_.reference->site.markers[i];
    return m.grating ? m.grating->centre : m.circle->centre;
  }
  static std::string short_text(const InspectedPatch& p) {
    const PatchAxes axes = axes_of(p.seen);
    return fmt::format("P {:.1f} px", std::max(length(axes.x), length(axes.y)));
  }
  void name_the_rest() {
    pen_.letters(kLetterSize, false);
    pen_.colour(kLatticeColour);
    for (const IndexedLattice& lattice : seen_.lattices) {
      pen_.label_outside(about(lattice), lattice_text(lattice), picture_);
    }
    pen_.colour(kUnidentifiedColour);
    for (const InspectedPatch& p : seen_.patches) {
      if (p.marker == kUnidentified)
        pen_.label_outside(corners_of(p), pattern_text(p.seen) + "\n" + short_text(p), picture_);
    }
    pen_.letters(0.85 * kLetterSize, false);
    pen_.colour(kRejectedColour);
    const auto rejected = rejected_to_draw(seen_);
    for (std::size_t i = 0; i < std::min(rejected.size(), kMaxReasons); ++i) {
      const RejectedOutline& r = *rejected[i];
      pen_.label_outside(corners_round(r.centre, r.diameter_px + 4.0), reason(r), picture_, kMaxCovered);
    }
  }
  // Returns "W = 0.79" or "W = 0.90: not an ellipse". The terminal and --json show the whole reason.
  static std::string reason(const RejectedOutline& r) {
    const std::string why = r.why.substr(0, r.why.find_first_of(":;(,"));
    return why.starts_with("W") ? why : fmt::format("W = {:.2f}: {}", r.circularity, why);
  }

  const InspectionOverlay& contents_;
  const Inspection& seen_;
  Pen& pen_;
  Box picture_;
};

// A piece of text in the strip below the image. Pieces flow into lines.
struct Piece {
  std::string text;
  Colour colour = kWhite;
  bool swatch = false;    // a coloured square before the text
  bool new_line = false;  // starts a new line
};

std::vector<Piece> legend_of(const InspectionOverlay& contents) {
  const Inspection& seen = contents.seen;
  std::vector<Piece> pieces{{contents.caption, kWhite, false, true}};
  const auto named = [&](Role role) {
    return !seen.reference ? 0
                           : std::count_if(seen.reference->site.markers.begin(), seen.reference->site.markers.end(),
                                           [&](const Marker& m) { return m.role == role; });
  };
  const auto unidentified = std::count_if(seen.circles.begin(), seen.circles.end(), [](const InspectedCircle& c) {
    return c.marker == kUnidentified && c.lattice == kUnidentified;
  });
  const auto spare = std::count_if(seen.patches.begin(), seen.patches.end(),
                                   [](const InspectedPatch& p) { return p.marker == kUnidentified; });
  const auto drawn = rejected_to_draw(seen).size();
  bool first = true;
  const auto count = [&](auto n, Colour colour, const char* one, const char* many) {
    if (n > 0)
      pieces.push_back({fmt::format("{} {}", n, n == 1 ? one : many), colour, true, std::exchange(first, false)});
  };
  count(named(Role::kReference), kReferenceColour, "reference (must not move)", "references (must not move)");
  count(named(Role::kTarget), kTargetColour, "target (may move)", "targets (may move)");
  count(unidentified, kUnidentifiedColour, "circle not used", "circles not used");
  count(spare, kUnidentifiedColour, "grating not used", "gratings not used");
  count(seen.lattices.size(), kLatticeColour, "lattice", "lattices");
  count(seen.rejected.size(), kRejectedColour, "outline rejected as a circle", "outlines rejected as circles");
  if (!seen.rejected.empty())
    pieces.back().text += drawn > 0 ? fmt::format(" ({} drawn, dashed)", drawn) : " (inside other markers)";
  for (const ExpectedUncertainty& e : contents.expected)
    pieces.push_back(
        {fmt::format("{}: expected {} (k = 1, {})", name_of(seen, static_cast<int>(e.marker)), expected_text(seen, e),
                     e.codec.x > 0.0 || e.codec.y > 0.0 ? "noise and codec" : "noise only"),
         kTargetColour, false, true});
  if (!seen.reference)
    pieces.push_back({"This frame cannot be measured: " + seen.missing, kRejectedColour, false, true});
  return pieces;
}

// Lays out the strip below the image, and breaks lines. Returns the strip's height. Without `top` it only measures.
class Strip {
 public:
  Strip(cairo_t* cr, Pen& pen, double width) : cr_(cr), pen_(pen), width_(width), pad_(8.0 * pen.unit()) {}
  double lay_out(const std::vector<Piece>& pieces, std::optional<double> top) {
    pen_.letters(kLetterSize, false);
    const double line = pen_.line_height() * 1.15;
    double x = pad_, y = top.value_or(0.0) + line;
    for (const Piece& piece : pieces) {
      const double swatch = piece.swatch ? 1.4 * line : 0.0;
      if (piece.new_line && x > pad_) next(x, y, line);
      if (x > pad_ && x + swatch + pen_.text_width(piece.text) > width_ - pad_) next(x, y, line);
      if (piece.swatch && top) mark(x, y, line, piece.colour);
      x += swatch;
      for (const std::string& part : broken(piece.text, width_ - pad_ - x)) {
        if (x + pen_.text_width(part) > width_ - pad_ && x > pad_ + swatch) next(x, y, line);
        if (top) write(x, y, part, piece.colour);
        x += pen_.text_width(part);
      }
      x += 2.0 * pad_;
    }
    return y + 0.6 * line - top.value_or(0.0);
  }

 private:
  void next(double& x, double& y, double line) const {
    x = pad_;
    y += line;
  }
  // Returns the whole text if it fits, otherwise its words.
  [[nodiscard]] std::vector<std::string> broken(const std::string& text, double room) const {
    if (pen_.text_width(text) <= room) return {text};
    std::vector<std::string> words(1);
    for (const char c : text) {
      words.back() += c;
      if (c == ' ') words.emplace_back();
    }
    return words;
  }
  void mark(double x, double y, double line, Colour c) {
    cairo_set_source_rgb(cr_, c.r, c.g, c.b);
    cairo_rectangle(cr_, x, y - 0.55 * line, line, 0.55 * line);
    cairo_fill(cr_);
  }
  void write(double x, double y, const std::string& text, Colour c) {
    cairo_set_source_rgb(cr_, c.r, c.g, c.b);
    cairo_move_to(cr_, x, y);
    cairo_show_text(cr_, text.c_str());
    cairo_new_path(cr_);
  }
  cairo_t* cr_;
  Pen& pen_;
  double width_, pad_;
};

}  // namespace

std::vector<std::uint8_t> draw_inspection(const InspectionOverlay& contents) {
  const int longest = std::max(contents.picture.width, contents.picture.height);
  const int scale = std::clamp(static_cast<int>(std::ceil(kReadableWidth_px / std::max(1, longest))), 1, 4);
  const int width = scale * contents.picture.width, height = scale * contents.picture.height;
  const double unit = std::max(1.0, scale * longest / 1400.0);
  const auto pieces = legend_of(contents);
  int strip = 0;
  {
    const Surface scratch(cairo_image_surface_create(CAIRO_FORMAT_RGB24, 1, 1), cairo_surface_destroy);
    const Context context(cairo_create(scratch.get()), cairo_destroy);
    Pen pen(context.get(), unit);
    strip = static_cast<int>(std::ceil(Strip(context.get(), pen, width).lay_out(pieces, std::nullopt)));
  }
  const Surface page = page_with(contents.picture, scale, width, height + strip);
  if (cairo_surface_status(page.get()) != CAIRO_STATUS_SUCCESS) return {};
  const Context context(cairo_create(page.get()), cairo_destroy);
  Pen pen(context.get(), unit, scale);
  Strip(context.get(), pen, width).lay_out(pieces, height);
  const Box picture{0.0, 0.0, static_cast<double>(width), static_cast<double>(height)};
  cairo_rectangle(context.get(), picture.x, picture.y, picture.width, picture.height);
  cairo_clip(context.get());
  InspectionDrawing(contents, pen, picture).draw();
  return png_of(page.get());
}

}  // namespace moiregauge::internal
