// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/io/config/site_draft.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "moiregauge/units/units.h"

namespace moiregauge::internal {
namespace {

constexpr double kPlace_px = 0.01, kSize_px = 0.1;  // rounding of positions and diameters, chosen
constexpr int kAngleDigits = 3;                     // decimals of degrees: 0.01 px over a grating of 600 px

// Writes numbers with the decimals that the image justifies.
class Rounding {
 public:
  explicit Rounding(double mm_per_px) : mm_per_px_(mm_per_px) {}
  [[nodiscard]] std::string length(double mm, double px) const { return number(mm, decimals(px)); }
  [[nodiscard]] std::string place(BoardPoint p) const {
    return fmt::format("[{}, {}]", length(p.x, kPlace_px), length(p.y, kPlace_px));
  }
  // Returns the number without zeros at its end, but with a point: TOML requires it.
  [[nodiscard]] static std::string number(double value, int decimals) {
    std::string text = fmt::format("{:.{}f}", value, decimals);
    while (decimals > 1 && text.back() == '0') {
      text.pop_back();
      --decimals;
    }
    return text == "-0.0" ? "0.0" : text;
  }

 private:
  // Returns the decimals whose last digit is at most this many pixels.
  [[nodiscard]] int decimals(double px) const {
    return std::clamp(static_cast<int>(std::ceil(-std::log10(px * mm_per_px_))), 1, 9);
  }
  double mm_per_px_;
};

std::string grating_text(const Grating& grating, const Rounding& rounding, double pitch_mm) {
  std::string text =
      fmt::format("grating_mm = {}\ngrating_size_mm = [{}, {}]\n", rounding.place(grating.centre),
                  rounding.length(grating.width_mm, kSize_px), rounding.length(grating.height_mm, kSize_px));
  if (grating.pitch_mm != pitch_mm) text += fmt::format("pitch_mm = {}\n", Rounding::number(grating.pitch_mm, 9));
  if (grating.pattern != Pattern::kAuto) text += fmt::format("pattern = \"{}\"\n", word_for(grating.pattern));
  const std::string angle = Rounding::number(degrees_from_radians(grating.angle_rad), kAngleDigits);
  if (angle != "0.0") text += fmt::format("angle_deg = {}\n", angle);
  return text;
}

std::string marker_text(const Marker& marker, const Rounding& rounding, double pitch_mm) {
  std::string text =
      fmt::format("\n[[{}]]\nname = \"{}\"\n", marker.role == Role::kReference ? "reference" : "target", marker.name);
  if (marker.circle) {
    text += fmt::format("circle_mm = {}\n", rounding.place(marker.circle->centre));
    if (marker.circle->diameter_mm > 0.0)
      text += fmt::format("circle_diameter_mm = {}\n", rounding.length(marker.circle->diameter_mm, kSize_px));
  }
  if (marker.grating) text += grating_text(*marker.grating, rounding, pitch_mm);
  if (marker.z_mm) text += fmt::format("z_mm = {}\n", Rounding::number(*marker.z_mm, 6));
  return text;
}

// Returns the text with each line commented out.
std::string commented(const std::string& text) {
  std::string out;
  bool is_at_start = true;
  for (const char c : text) {
    if (is_at_start && c != '\n') out += "# ";
    out += c;
    is_at_start = c == '\n';
  }
  return out;
}

Grating grating_of(const DetectedPatch& patch, const View& view) {
  Grating grating;
  grating.centre = view.board(patch.centre);
  const PatchAxes axes = axes_of(patch);
  const ImageExtent along = length(axes.x) > 0.0 ? axes.x : axes.y;
  const auto step = view.board(patch.centre + along) - grating.centre;
  grating.pitch_mm = std::hypot(step.x, step.y);
  grating.width_mm = patch.periods_x * grating.pitch_mm;
  grating.height_mm = patch.periods_y * grating.pitch_mm;
  grating.pattern = patch.pattern;
  return grating;
}

// Returns circles and gratings that are no marker, as entries to be completed by the user.
std::string unused_text(const Inspection& seen, const Rounding& rounding) {
  const View& view = seen.reference->view;
  std::string text;
  int circles = 0, gratings = 0;
  for (const InspectedCircle& circle : seen.circles) {
    if (circle.marker != kUnidentified || circle.lattice != kUnidentified) continue;
    Marker marker;
    marker.name = fmt::format("C{}", ++circles);
    const BoardPoint centre = view.board(circle.seen.centre);
    marker.circle = Circle{centre, circle.seen.diameter_px * view.mm_per_px(centre)};
    text += fmt::format("\n# Not used: a circle at ({:.0f}, {:.0f}) px.", circle.seen.centre.x, circle.seen.centre.y) +
            commented(marker_text(marker, rounding, 0.0));
  }
  for (const InspectedPatch& patch : seen.patches) {
    if (patch.marker != kUnidentified) continue;
    Marker marker;
    marker.name = fmt::format("G{}", ++gratings);
    marker.role = Role::kTarget;
    marker.grating = grating_of(patch.seen, view);
    marker.grating->pitch_mm = std::stod(Rounding::number(marker.grating->pitch_mm, 3));
    text += fmt::format("\n# Not used: a grating at ({:.0f}, {:.0f}) px.", patch.seen.centre.x, patch.seen.centre.y) +
            commented(marker_text(marker, rounding, 0.0));
  }
  if (text.empty()) return text;
  return "\n# Circles and gratings that are no marker. Remove the # of an entry to use it.\n" + text;
}

// Returns the pitch of most gratings.
double common_pitch_mm(const Site& site) {
  double best = 0.0;
  long most = 0;
  for (const Marker& marker : site.markers) {
    if (!marker.grating) continue;
    const double pitch = marker.grating->pitch_mm;
    const auto count = std::count_if(site.markers.begin(), site.markers.end(),
                                     [&](const Marker& m) { return m.grating && m.grating->pitch_mm == pitch; });
    if (count > most) most = count, best = pitch;
  }
  return best;
}

}  // namespace

std::string site_draft(const Inspection& seen, const std::string& title) {
  const Site& site = seen.reference->site;
  const Marker& first = site.markers.front();
  const Rounding rounding(seen.reference->view.mm_per_px(first.circle ? first.circle->centre : first.grating->centre));
  const double pitch_mm = common_pitch_mm(site);
  std::string text = fmt::format(
      "# Markers in {}, found by moiregauge inspect.\n# Lengths in millimetres; x right, y up, z towards "
      "the camera.\n\n[grating]\npitch_mm = {}        # check it with a ruler: it is the scale\n",
      title, Rounding::number(pitch_mm, 9));
  const auto put_role = [&](Role role, const char* comment) {
    text += fmt::format("\n# {}\n", comment);
    for (const Marker& marker : site.markers) {
      if (marker.role == role) text += marker_text(marker, rounding, pitch_mm);
    }
  };
  put_role(Role::kReference, "References: each must be fixed. Rename or remove one, or make it a [[target]].");
  put_role(Role::kTarget, "Targets: these may move.");
  const KnownTo& known = site.known_to;
  text += fmt::format(
      "\n# Standard uncertainties of the values above. A better survey has smaller ones.\n[known_to]\n"
      "position_mm = {}\nrotation_deg = {}\nheight_mm = {}\nprint_scale = {}\n",
      Rounding::number(known.position_mm, 6), Rounding::number(degrees_from_radians(known.rotation_rad), 6),
      Rounding::number(known.height_mm, 6), Rounding::number(known.print_scale, 9));
  return text + unused_text(seen, rounding);
}

}  // namespace moiregauge::internal
